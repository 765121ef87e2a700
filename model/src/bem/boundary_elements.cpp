#include "fringe/boundary_elements.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include <fmt/format.h>

#include "bem/bodies.hpp"
#include "bem/group_densities.hpp"
#include "bem/marking.hpp"
#include "bem/maxwell_matrix.hpp"
#include "bem/mesh_size.hpp"
#include "bem/panel_system.hpp"
#include "fringe/error.hpp"

namespace fringe {
namespace {

using detail::changes;
using detail::ChargedBodies;
using detail::FaceFunctions;
using detail::NestedMatrix;
using detail::PanelSolution;
using detail::PanelSystem;
using detail::without_floating;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double strictest_rtol = 1e-6;
constexpr double loosest_rtol = 0.5;

/// What the change from the smaller space to the larger says of the error that is left. An error that falls
/// like the third power of the number of functions is 0.57 of the change when there are 1.4 times as many,
/// and plates on their own show the power 3.3 or more. Narrow features that are only just seen do worse: in
/// random poses (BOUNDARY_ELEMENTS.md, section 7) 1.2 times the change was met.
constexpr double error_per_change = 1.5;

/// Where there are more features than functions: two spaces that both miss them agree. In random near poses
/// ten times the change was met.
constexpr double error_per_unresolved_change = 15;

/// How much of what the quadratures may do to the answer at most they do: where it was looked at, 0.001 or
/// less.
constexpr double quadrature_caution = 0.01;

/// Below this, rounding decides over the elements of the matrix.
constexpr double finest_tolerance = 1e-13;

/// The part of rtol that the quadratures may take.
constexpr double quadrature_part = 0.05;

/// How much finer than rtol the quadratures begin: functions that resolve everything leave errors far below
/// rtol, which the quadratures' must be well below in turn for a lower bound.
constexpr double first_tolerance_part = 50;

/// The part of rtol at which the panels' iteration ends.
constexpr double iteration_share = 0.003;

/// The part of rtol that panels graded towards sharp edges may miss, one density on each group. It is about
/// the change from the smaller space to the whole.
constexpr double grading_part = 1.0 / 3;

/// Grading alone takes no more than one in so many of the unknowns there may be.
constexpr std::size_t most_graded_part = 4;

void validate(const BoundaryElementOptions& options) {
  if (!(options.rtol >= strictest_rtol && options.rtol <= loosest_rtol))
    throw InputError(
        fmt::format("rtol {} must be from {} to {}", options.rtol, strictest_rtol, loosest_rtol));
}

void require_positive_definite(const PanelSolution& solution) {
  if (!solution.positive_definite)
    throw std::runtime_error("the matrix of the boundary elements is not positive definite");
}

/// What the quadratures may do to the first conductors' entries.
MatrixXd quadrature_errors(const PanelSolution& solution, double tolerance, Index conductors) {
  return quadrature_caution * tolerance * solution.quadrature_effect.topLeftCorner(conductors, conductors);
}

/// The answer in metres, to be multiplied by 4πε.
void tell(const PanelSolution& solution, const ChargedBodies& bodies, double per_change, double tolerance,
          MaxwellMatrix& answer) {
  const MatrixXd fine = without_floating(solution.all.fine, bodies.floating);
  const MatrixXd coarse = without_floating(solution.all.coarse, bodies.floating);
  const Index conductors = fine.rows();
  const MatrixXd quadrature = quadrature_errors(solution, tolerance, conductors);
  answer.values = fine;
  answer.errors = per_change * changes(fine, coarse) + quadrature +
                  solution.unfinished.topLeftCorner(conductors, conductors);
  answer.lower_bounds.resize(static_cast<std::size_t>(conductors));
  for (Index i = 0; i < conductors; ++i)
    answer.lower_bounds[static_cast<std::size_t>(i)] =
        quadrature(i, i) <= quadrature_part * answer.errors(i, i);
}

/// What the objects add to the sensors' own entries, in metres. The errors of a sensor's edges, which it has
/// without the objects, too, are not in the difference.
void tell_delta(const PanelSystem& system, const PanelSolution& solution, const ChargedBodies& bodies,
                double per_change, double tolerance, double accuracy, MaxwellMatrix& answer) {
  const auto sensors = static_cast<Index>(bodies.sensors);
  NestedMatrix alone = solution.sensors;
  VectorXd others = quadrature_errors(solution, tolerance, sensors).diagonal() +
                    solution.unfinished.diagonal().head(sensors);
  if (detail::sensors_have_panels(bodies)) {
    const PanelSolution again = system.solve_sensors(accuracy);
    require_positive_definite(again);
    alone = again.all;
    others += quadrature_errors(again, tolerance, sensors).diagonal() + again.unfinished.diagonal();
  }
  const VectorXd fine = answer.values.diagonal().head(sensors);
  const VectorXd coarse = without_floating(solution.all.coarse, bodies.floating).diagonal().head(sensors);
  answer.delta_self = fine - alone.fine.diagonal();
  const VectorXd change = answer.delta_self - (coarse - alone.coarse.diagonal());
  const VectorXd relative = 1 - coarse.array() / fine.array();
  answer.delta_self_errors =
      per_change * change.cwiseAbs().cwiseMax(relative.cwiseProduct(answer.delta_self).cwiseAbs()) + others;
}

/// The largest error of an entry, relative to it; of delta_self relative to the sensor's own entry, as a far
/// object's vanishes.
double largest_error(const MaxwellMatrix& answer) {
  return (answer.errors.array() / answer.values.array().abs()).maxCoeff();
}

/// More than is asked, not to come back for a little.
constexpr double excess_margin = 1.25;

/// The missing energy that is allowed after a refinement, by what the highest functions and the groups of
/// panels hold.
double allowed_energy(const PanelSolution& solution, double excess) {
  double total = solution.group_energies.sum();
  for (const Eigen::Vector2d& highest : solution.highest)
    total += highest.sum();
  return total / (excess_margin * excess);
}

/// More functions where the highest ones hold more than their part of the allowed energy. False when none may
/// be added.
bool add_functions(const PanelSolution& solution, double allowed_of_all, double excess,
                   std::vector<FaceFunctions>& functions) {
  /// The missing energy falls like this power of the number of functions.
  constexpr double power = 4;
  /// The whole error falls at least like the third, faster where features are only just resolved.
  const double most_growth = std::min(std::cbrt(excess_margin * excess), 2.0);
  const double allowed = allowed_of_all / (2 * static_cast<double>(functions.size()));
  bool added = false;
  const auto grow = [&](int& count, double energy) {
    if (!(energy > allowed) || count == detail::most_functions)
      return;
    const double growth = std::min(std::pow(energy / allowed, 1 / power), most_growth);
    // The nearest odd number.
    const int wanted = 2 * static_cast<int>(growth * count / 2) + 1;
    count = std::min(std::max(wanted, count + 2), detail::most_functions);
    added = true;
  };
  for (std::size_t face = 0; face < functions.size(); ++face) {
    grow(functions[face].u, solution.highest[face][0]);
    grow(functions[face].v, solution.highest[face][1]);
  }
  return added;
}

std::size_t count_unknowns(const std::vector<FaceFunctions>& functions) {
  std::size_t unknowns = 0;
  for (const FaceFunctions& face : functions)
    unknowns += static_cast<std::size_t>(face.count());
  return unknowns;
}

/// With how many functions to begin, and what a change from one space to another says of the error then.
struct Beginning {
  std::vector<FaceFunctions> functions;
  double error_per_change;
};

/// See detail::resolving_functions.
double features(const BoundaryElementOptions& options) {
  return options.rtol > 3e-3 ? 1 : 2;
}

Beginning beginning(const ChargedBodies& bodies, std::size_t panels, const BoundaryElementOptions& options) {
  const int least = options.rtol >= 0.01 ? 5 : 7;
  Beginning result{detail::resolving_functions(bodies, features(options), least),
                   panels > 0 ? detail::error_per_panel_change : error_per_change};
  if (count_unknowns(result.functions) + panels > options.most_unknowns)
    result = {detail::resolving_functions(bodies, 0, least), error_per_unresolved_change};
  if (count_unknowns(result.functions) + panels > options.most_unknowns)
    throw InputError(fmt::format("the scene takes {} unknowns or more: boundary elements end at {}",
                                 count_unknowns(result.functions) + panels, options.most_unknowns));
  return result;
}

/// False when nothing may be added.
bool refine(PanelSystem& system, const PanelSolution& solution, double excess, std::size_t most_unknowns,
            std::vector<FaceFunctions>& functions) {
  const std::size_t panels = system.mesh().panels().size();
  if (panels == 0) {
    std::vector<FaceFunctions> more = functions;
    if (!add_functions(solution, allowed_energy(solution, excess), excess, more) ||
        count_unknowns(more) > most_unknowns)
      return false;
    functions = more;
    return true;
  }
  /// Faces and panels have half each.
  const double allowed = allowed_energy(solution, excess) / 2;
  bool added = add_functions(solution, allowed, excess, functions);
  const std::size_t used = count_unknowns(functions) + panels;
  if (used > most_unknowns)
    return false;
  /// A solution takes several times as long with twice as many; what the charges tell now is worth that.
  const std::vector<bool> marked = detail::groups_to_refine(system.mesh().groups(), solution.group_energies,
                                                            allowed, std::min(panels, most_unknowns - used));
  if (!marked.empty()) {
    system.refine_groups(marked, solution.charges);
    added = true;
  }
  return added;
}

/// The answer in metres, to be multiplied by 4πε.
MaxwellMatrix solve(const ChargedBodies& bodies, const BoundaryElementOptions& options) {
  PanelSystem system(bodies, {grading_part * options.rtol, options.most_unknowns / most_graded_part});
  auto [functions, per_change] = beginning(bodies, system.mesh().panels().size(), options);

  MaxwellMatrix answer;
  const auto rows = static_cast<std::ptrdiff_t>(bodies.names.size() - bodies.floating);
  answer.conductors.assign(bodies.names.begin(), bodies.names.begin() + rows);
  answer.floating.assign(bodies.names.begin() + rows, bodies.names.end());
  answer.sensors = bodies.sensors;
  double tolerance = options.rtol / first_tolerance_part;
  const double accuracy = iteration_share * options.rtol;
  PanelSolution solution;
  while (true) {
    system.refine(functions, tolerance);
    solution = system.solve(accuracy);
    if (!solution.positive_definite) {
      if (tolerance < finest_tolerance)
        require_positive_definite(solution);
      tolerance /= 100;
      continue;
    }
    tell(solution, bodies, per_change, tolerance, answer);
    answer.unknowns = count_unknowns(functions) + system.mesh().panels().size();
    const double excess = largest_error(answer) / options.rtol;
    answer.reached = excess <= 1;
    if (answer.reached)
      break;
    // What the quadratures may do grows with the charges, near contact without limit.
    const double quadrature =
        quadrature_caution * tolerance *
        (solution.quadrature_effect.topLeftCorner(answer.values.rows(), answer.values.cols()).array() /
         answer.values.array().abs())
            .maxCoeff();
    const bool tightened = quadrature > quadrature_part * options.rtol;
    if (tightened)
      tolerance *= quadrature_part * options.rtol / quadrature / 2;
    if (!refine(system, solution, excess, options.most_unknowns, functions) && !tightened)
      break;
  }
  tell_delta(system, solution, bodies, per_change, tolerance, accuracy, answer);
  return answer;
}

/// solve() for bodies some of which have triangles in the place of their faces.
MaxwellMatrix solve_in_triangles(const ChargedBodies& bodies, BoundaryElementOptions options) {
  /// What they reach in seconds; less would take minutes.
  constexpr double reached_by_triangles = 1e-3;
  options.rtol = std::max(options.rtol, reached_by_triangles);
  return solve(bodies, options);
}

/// The answer, with triangles in the place of faces whose functions would see nothing of what is before
/// them: two spaces that both miss something agree.
MaxwellMatrix solve_as_needed(const ChargedBodies& bodies, const BoundaryElementOptions& options) {
  if (const auto others = detail::with_triangles_under_narrow_shadows(bodies))
    return solve_in_triangles(*others, options);
  MaxwellMatrix answer = solve(bodies, options);
  /// An answer that is better than this is not worth the seconds.
  constexpr double useless = 1e-2;
  if (largest_error(answer) <= std::max(useless, options.rtol))
    return answer;
  if (const auto others = detail::with_triangles_beyond(bodies, features(options), detail::most_functions))
    if (MaxwellMatrix other = solve_in_triangles(*others, options);
        largest_error(other) < largest_error(answer))
      return other;
  return answer;
}

}  // namespace

MaxwellMatrix maxwell(const Scene& scene, const BoundaryElementOptions& options) {
  validate(options);
  if (scene.has_room)
    throw InputError("room: boundary elements know only free space");
  const ChargedBodies bodies = detail::charged_bodies(scene);
  if (bodies.names.size() == bodies.floating)
    throw InputError("the scene has neither a sensor nor a grounded object");
  MaxwellMatrix answer = solve_as_needed(bodies, options);
  answer.reached = largest_error(answer) <= options.rtol;
  const double factor = 4 * std::numbers::pi * vacuum_permittivity * scene.medium.relative_permittivity;
  answer.values *= factor;
  answer.errors *= factor;
  answer.delta_self *= factor;
  answer.delta_self_errors *= factor;
  return answer;
}

SceneCapacitance capacitance(const Scene& scene, const MaxwellMatrix& matrix) {
  SceneCapacitance answer;
  for (std::size_t s = 0; s < matrix.sensors; ++s) {
    SensorCapacitance felt{matrix.conductors[s], 0, 0, 0, false, {}};
    for (std::size_t k = matrix.sensors; k < matrix.conductors.size(); ++k) {
      felt.objects.push_back({matrix.conductors[k], matrix.mutual(s, k), 0, false});
      felt.total += felt.objects.back().capacitance;
    }
    felt.voltage = divider_voltage(scene.sensors[s], felt.total);
    felt.delta_voltage = scene.sensors[s].input_voltage - felt.voltage;
    answer.sensors.push_back(std::move(felt));
  }
  return answer;
}

}  // namespace fringe
