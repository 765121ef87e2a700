#include "fringe/boundary_elements.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "bem/asked_error.hpp"
#include "bem/bodies.hpp"
#include "bem/error_indicators.hpp"
#include "bem/group_densities.hpp"
#include "bem/insulated_maxwell.hpp"
#include "bem/insulators.hpp"
#include "bem/matrix_readings.hpp"
#include "bem/maxwell_matrix.hpp"
#include "bem/mesh_size.hpp"
#include "bem/panel_system.hpp"
#include "bem/reading_derivatives.hpp"
#include "bem/readings.hpp"
#include "bem/simplification.hpp"
#include "fringe/error.hpp"
#include "fringe/interruption.hpp"
#include "numeric/infinity.hpp"

namespace fringe {
namespace {

using detail::changes;
using detail::ChargedBodies;
using detail::FaceFunctions;
using detail::largest_error;
using detail::NestedMatrix;
using detail::PanelSolution;
using detail::PanelSystem;
using detail::Role;
using detail::Simplification;
using detail::without_floating;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double strictest_rtol = 1e-6;
constexpr double loosest_rtol = 0.5;

/// Estimated error in the whole space, per change from the coarse space to it. If the error falls like the
/// third power of the number of functions, it is 0.57 of the change when there are 1.4 times as many;
/// isolated plates show the power 3.3 or more. Narrow features that are only just resolved do worse: in
/// random poses (BOUNDARY_ELEMENTS.md, section 7) the error reached 1.2 times the change.
constexpr double error_per_change = 1.5;

/// The same factor with the functions that an rtol above `every_feature` begins with. A sensor before a guard
/// that is larger leaves an edge in the guard's charge; there the error reached 2.1 times the change.
constexpr double error_per_coarse_change = 3;

/// Largest rtol at which the first functions resolve all features twice.
constexpr double every_feature = 3e-3;

/// The same factor where there are more features than functions: two spaces that both miss them agree. In
/// random near poses the error reached ten times the change.
constexpr double error_per_unresolved_change = 15;

/// Assumed effect of the quadrature errors on the result, relative to the worst case; the measured effect was
/// 0.001 or less.
constexpr double quadrature_caution = 0.01;

/// Finest relative tolerance of the quadratures. Below it, rounding errors dominate the matrix elements.
constexpr double finest_tolerance = 1e-13;

/// Fraction of rtol that the quadrature errors may take.
constexpr double quadrature_part = 0.05;

/// Factor by which one refinement reduces the error at most. While the error exceeds what is allowed by more,
/// quadratures as fine as those of the last step would be in vain.
constexpr double most_excess_in_a_step = 10;

/// Ratio of rtol to the first tolerance of the quadratures. Functions that resolve everything leave errors
/// far below rtol, and the quadrature errors must be well below those to give a lower bound.
constexpr double first_tolerance_part = 50;

/// Fraction of rtol at which the conjugate gradients for the panels' charges stop. The error indicators of
/// groups, small parts of the energy, have to be known, too.
constexpr double iteration_share = 0.0005;

/// Assumed change of a reading, as a part of its value, before it is known.
constexpr double first_change_part = 1e-2;

/// Ratio of the tolerance of simplified surfaces to rtol. The surfaces move by a fraction of the tolerance on
/// average, and only a part of the charge is where it counts.
constexpr double simplification_part = 3;

/// The triangles of all bodies are at most one in so many of the allowed unknowns: the others are for
/// refinement.
constexpr std::size_t most_triangles_part = 2;

void require_positive_definite(const PanelSolution& solution) {
  if (!solution.positive_definite)
    throw std::runtime_error("the matrix of the boundary elements is not positive definite");
}

/// Returns the possible effect of the quadrature errors on the first conductors' entries.
MatrixXd quadrature_errors(const PanelSolution& solution, double tolerance, Index conductors) {
  return quadrature_caution * tolerance * solution.quadrature_effect.topLeftCorner(conductors, conductors);
}

/// Writes the matrix and its estimated errors to the answer, in metres (to be multiplied by 4πε).
/// `geometry` are the errors by surfaces that are not the bodies'; `is_within` tells whether they lie within
/// these.
void write_solution(const PanelSolution& solution, const ChargedBodies& bodies, double per_change,
                    double tolerance, const MatrixXd& geometry, bool is_within, MaxwellMatrix& answer) {
  const MatrixXd fine = without_floating(solution.all.fine, bodies);
  const MatrixXd coarse = without_floating(solution.all.coarse, bodies);
  const Index conductors = fine.rows();
  const MatrixXd quadrature = quadrature_errors(solution, tolerance, conductors);
  answer.values = fine;
  answer.charges = detail::member_charges(solution.all.fine, solution.body_charges, bodies);
  answer.errors = per_change * changes(fine, coarse) + quadrature +
                  solution.iteration_error.topLeftCorner(conductors, conductors) + geometry;
  answer.lower_bounds.resize(static_cast<std::size_t>(conductors));
  for (Index i = 0; i < conductors; ++i)
    answer.lower_bounds[static_cast<std::size_t>(i)] =
        is_within && quadrature(i, i) <= quadrature_part * (answer.errors(i, i) - geometry(i, i));
}

/// Writes the readings, in metres. `geometry` are the errors by surfaces that are not the bodies';
/// `is_within` tells whether they lie within these.
void write_readings(const PanelSolution& solution, const ChargedBodies& bodies, double per_change,
                    double tolerance, const detail::ReadingEffects& geometry, bool is_within,
                    MaxwellMatrix& answer) {
  if (bodies.readings.empty())
    return;
  detail::ReadingEffects others =
      detail::reading_effects(quadrature_caution * tolerance * solution.reading_quadrature_effect);
  others += detail::reading_effects(solution.iteration_error, solution.background_iteration_error, bodies);
  answer.readings = detail::reading_answers(solution.all, solution.background, per_change,
                                            detail::reading_effects(solution.reading_details), others,
                                            is_within ? quadrature_part : 0, bodies);
  for (std::size_t k = 0; k < answer.readings.size(); ++k) {
    ReadingAnswer& reading = answer.readings[k];
    *reading.value.error += geometry.value[static_cast<Index>(k)];
    *reading.background.error += geometry.background[static_cast<Index>(k)];
    *reading.change.error += geometry.change[static_cast<Index>(k)];
  }
}

/// Writes that nothing is known about what the objects add to the sensors' own entries.
void write_no_delta_self(MaxwellMatrix& answer) {
  const auto sensors = static_cast<Index>(answer.sensors);
  answer.delta_self = VectorXd::Zero(sensors);
  answer.delta_self_errors = VectorXd::Constant(sensors, detail::infinity);
}

/// Writes what the objects add to the sensors' own entries, in metres. The errors at a sensor's edges, which
/// are the same without the objects, cancel in this difference.
void write_delta_self(const PanelSystem& system, const PanelSolution& solution, const ChargedBodies& bodies,
                      double per_change, double tolerance, double accuracy, const MatrixXd& geometry,
                      MaxwellMatrix& answer) {
  const auto sensors = static_cast<Index>(answer.sensors);
  NestedMatrix alone = solution.sensors;
  if (alone.fine.size() > 0)
    alone = {alone.fine.topLeftCorner(sensors, sensors), alone.coarse.topLeftCorner(sensors, sensors)};
  VectorXd others = quadrature_errors(solution, tolerance, sensors).diagonal() +
                    solution.iteration_error.diagonal().head(sensors) + geometry.diagonal().head(sensors);
  if (detail::sensors_have_panels(bodies)) {
    PanelSolution again;
    try {
      again = system.solve_sensors(accuracy);
    } catch (const Interrupted&) {
      write_no_delta_self(answer);
      return;
    }
    require_positive_definite(again);
    alone = again.all;
    others += quadrature_errors(again, tolerance, sensors).diagonal() + again.iteration_error.diagonal();
  }
  const VectorXd fine = answer.values.diagonal().head(sensors);
  const VectorXd coarse = without_floating(solution.all.coarse, bodies).diagonal().head(sensors);
  answer.delta_self = fine - alone.fine.diagonal();
  const VectorXd change = answer.delta_self - (coarse - alone.coarse.diagonal());
  const VectorXd relative = 1 - coarse.array() / fine.array();
  answer.delta_self_errors =
      per_change * change.cwiseAbs().cwiseMax(relative.cwiseProduct(answer.delta_self).cwiseAbs()) + others;
}

/// Factor by which a refinement aims below the allowed error, to save a further refinement for a small
/// excess.
constexpr double excess_margin = 1.25;

/// Returns the missing energy that is allowed after a refinement. The energy that is missing now is estimated
/// by that of the highest functions and of the groups of panels.
double allowed_energy(const PanelSolution& solution, double excess) {
  double total = solution.error_indicators.sum();
  for (const Eigen::Vector2d& highest : solution.highest)
    total += highest.sum();
  return total / (excess_margin * excess);
}

/// Adds functions where the highest ones hold more than their share of the allowed energy. Returns false if
/// none were added.
bool add_functions(const PanelSolution& solution, double allowed_of_all, double excess,
                   std::vector<FaceFunctions>& functions) {
  /// Exponent: the missing energy falls like this power of the number of functions.
  constexpr double power = 4;
  /// Largest growth of the number of functions. The total error falls at least like its third power, and
  /// faster where features are only just resolved.
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

/// The functions to begin with, and the estimated error per change between the two spaces that goes with
/// them.
struct Beginning {
  std::vector<FaceFunctions> functions;
  double error_per_change;
};

/// Returns the parameter `features` of detail::a_priori_functions for the requested accuracy.
double features(const BoundaryElementOptions& options) {
  return options.rtol > every_feature ? 1 : 2;
}

Beginning beginning(const ChargedBodies& bodies, std::size_t panels, const BoundaryElementOptions& options) {
  const int least = options.rtol >= 0.01 ? 5 : 7;
  Beginning result{detail::a_priori_functions(bodies, features(options), least),
                   panels > 0                     ? detail::error_per_panel_change
                   : options.rtol > every_feature ? error_per_coarse_change
                                                  : error_per_change};
  if (count_unknowns(result.functions) + panels > options.most_unknowns)
    result = {detail::a_priori_functions(bodies, 0, least), error_per_unresolved_change};
  if (count_unknowns(result.functions) + panels > options.most_unknowns)
    throw InputError(fmt::format("the scene needs at least {} unknowns: boundary elements take at most {}",
                                 count_unknowns(result.functions) + panels, options.most_unknowns));
  return result;
}

/// Refines functions and panels where the error indicators are large. Returns false if nothing may be added.
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
  /// Faces and panels may miss half of the energy each.
  const double allowed = allowed_energy(solution, excess) / 2;
  bool added = add_functions(solution, allowed, excess, functions);
  const std::size_t used = count_unknowns(functions) + panels;
  if (used > most_unknowns)
    return false;
  /// A step at most doubles the number of panels. The next solution then takes several times as long, which
  /// the present error indicators justify.
  const std::vector<bool> marked = detail::doerfler_marking(system.mesh().groups(), solution.error_indicators,
                                                            allowed, std::min(panels, most_unknowns - used));
  if (!marked.empty()) {
    system.refine_groups(marked, solution.charges);
    added = true;
  }
  return added;
}

/// Returns the smallest change of a reading, as a part of its value.
double smallest_part(const std::vector<ReadingAnswer>& readings) {
  double smallest = 1;
  for (const ReadingAnswer& reading : readings) {
    const double value = reading.value.value.value_or(0), change = reading.change.value.value_or(0);
    if (value != 0)
      smallest = std::min(smallest, detail::change_scale(value, change) / std::abs(value));
  }
  return smallest;
}

/// Returns the largest effect of quadrature errors relative to what is asked for, for a unit error.
double quadrature_excess(const PanelSolution& solution, const ChargedBodies& bodies,
                         const MaxwellMatrix& answer) {
  double excess =
      (solution.quadrature_effect.topLeftCorner(answer.values.rows(), answer.values.cols()).array() /
       detail::error_scales(answer, bodies))
          .maxCoeff();
  if (!bodies.readings.empty())
    excess = std::max(excess, (detail::reading_effects(solution.reading_quadrature_effect).change.array() /
                               detail::change_scales(solution.all, solution.background, bodies).array())
                                  .maxCoeff());
  return excess;
}

/// Solves with adaptive refinement. The answer is in metres, to be multiplied by 4πε. Derivatives with
/// respect to the poses are found if there are any; null: none.
MaxwellMatrix solve(const ChargedBodies& bodies, const Simplification& simplification,
                    const BoundaryElementOptions& options, const detail::LinkPoses* poses) {
  PanelSystem system(bodies,
                     {detail::grading_part * options.rtol, options.most_unknowns / detail::most_graded_part},
                     options.threads);
  auto [functions, per_change] = beginning(bodies, system.mesh().panels().size(), options);

  MaxwellMatrix answer = detail::named_answer(bodies);
  double tolerance = options.rtol / first_tolerance_part;
  const double accuracy = iteration_share * options.rtol;
  PanelSolution solution;
  const auto conductors = static_cast<Index>(answer.conductors.size());
  detail::Progress progress;
  const VectorXd none = VectorXd::Zero(static_cast<Index>(bodies.readings.size()));
  detail::GeometryErrors geometry{
      MatrixXd::Zero(conductors, conductors), {none, none, none}, !simplification.is_changed()};
  double change_part = bodies.readings.empty() ? 1 : first_change_part;
  bool is_interrupted = false;
  while (true) {
    try {
      system.refine(functions, tolerance);
      solution = system.solve(accuracy * change_part);
    } catch (const Interrupted&) {
      if (answer.unknowns == 0)
        throw;
      is_interrupted = true;
      break;
    }
    if (!solution.positive_definite) {
      if (tolerance < finest_tolerance)
        require_positive_definite(solution);
      tolerance /= 100;
      continue;
    }
    if (simplification.differs()) {
      geometry.entries = effect_on_capacitances(
          simplification, system.mesh(), solution.charges * detail::potentials(solution.all.fine, bodies));
      if (!bodies.readings.empty())
        geometry.readings = detail::reading_effects(
            effect_on_capacitances(simplification, system.mesh(), solution.reading_charges));
    }
    write_solution(solution, bodies, per_change, tolerance, geometry.entries, simplification.is_within(),
                   answer);
    write_readings(solution, bodies, per_change, tolerance, geometry.readings, simplification.is_within(),
                   answer);
    answer.unknowns = count_unknowns(functions) + system.mesh().panels().size();
    if (!bodies.readings.empty())
      change_part = smallest_part(answer.readings);
    const double excess = detail::excess_error(answer, bodies, geometry, options.rtol);
    if (excess <= 1 || progress.is_in_vain(excess, answer.unknowns))
      break;
    if (options.before_refinement)
      options.before_refinement({answer.unknowns, excess * options.rtol});
    // The possible effect of the quadrature errors grows with the charges, without limit near contact.
    const double quadrature = quadrature_caution * tolerance * quadrature_excess(solution, bodies, answer);
    const double allowed = quadrature_part * options.rtol * std::max(excess / most_excess_in_a_step, 1.0);
    const bool tightened = quadrature > allowed;
    if (tightened)
      tolerance *= allowed / quadrature / 2;
    if (!refine(system, solution, excess, options.most_unknowns, functions) && !tightened)
      break;
  }
  if (poses != nullptr && !is_interrupted)
    detail::write_derivatives(charge_nodes(system, solution, bodies), bodies, *poses, options.threads,
                              answer.readings);
  write_delta_self(system, solution, bodies, per_change, tolerance, accuracy, geometry.entries, answer);
  if (bodies.readings.empty())
    answer.readings = detail::readings_of_sensors(answer);
  return answer;
}

/// Solves as solve() does, for bodies some of which have triangles in place of their faces.
MaxwellMatrix solve_in_triangles(const ChargedBodies& bodies, const Simplification& simplification,
                                 BoundaryElementOptions options, const detail::LinkPoses* poses) {
  /// Relative accuracy that triangles reach in seconds; a smaller value would take minutes.
  constexpr double reached_by_triangles = 1e-3;
  options.rtol = std::max(options.rtol, reached_by_triangles);
  return solve(bodies, simplification, options, poses);
}

/// Solves with functions on faces, or with triangles in place of faces whose functions would miss another
/// body close by: two spaces that both miss a feature agree. Retries with triangles if the error of the
/// faces' functions stays large.
MaxwellMatrix solve_as_needed(const Simplification& simplification, const BoundaryElementOptions& options,
                              const detail::LinkPoses* poses) {
  const ChargedBodies& bodies = simplification.bodies();
  if (const auto others = detail::with_triangles_by_proximity(bodies))
    return solve_in_triangles(*others, simplification, options, poses);
  MaxwellMatrix answer = solve(bodies, simplification, options, poses);
  /// Relative error above which a second solution with triangles is worth its seconds.
  constexpr double useless = 1e-2;
  if (largest_error(answer, bodies) <= std::max(useless, options.rtol))
    return answer;
  try {
    if (const auto others = detail::with_triangles_beyond(bodies, features(options), detail::most_functions))
      if (MaxwellMatrix other = solve_in_triangles(*others, simplification, options, poses);
          largest_error(other, bodies) < largest_error(answer, bodies))
        return other;
  } catch (const Interrupted&) {
    return answer;
  }
  return answer;
}

/// Writes which conductors and entries have to be accurate.
void choose_asked(Entries entries, ChargedBodies& bodies) {
  const std::size_t grounded = count_of(bodies, Role::grounded) + count_of(bodies, Role::floating);
  if (entries == Entries::all || grounded == bodies.conductors.size())
    return;
  bodies.are_entries_asked = entries != Entries::of_readings;
  if (!bodies.are_entries_asked && !bodies.readings.empty()) {
    VectorXd used = VectorXd::Zero(bodies.readings.front().sense.size());
    for (const detail::ChargedReading& reading : bodies.readings)
      used += reading.sense.cwiseAbs() + reading.drive;
    for (Index k = 0; k < used.size(); ++k) {
      detail::ChargedConductor& conductor = bodies.conductors[static_cast<std::size_t>(k)];
      conductor.is_asked = used[k] > 0 || conductor.role == Role::floating;
    }
    return;
  }
  for (detail::ChargedConductor& conductor : bodies.conductors)
    conductor.is_asked = conductor.role != Role::grounded;
}

MaxwellMatrix solve_conductors(const Scene& scene, const BoundaryElementOptions& options) {
  ChargedBodies bodies = detail::charged_bodies(scene, options.derivatives);
  choose_asked(options.entries, bodies);
  const Simplification simplification(std::move(bodies), simplification_part * options.rtol,
                                      options.most_unknowns / most_triangles_part);
  std::optional<detail::LinkPoses> poses;
  if (options.derivatives)
    poses.emplace(scene.links).update();
  MaxwellMatrix answer = solve_as_needed(simplification, options, poses ? &*poses : nullptr);
  answer.reached = largest_error(answer, simplification.bodies()) <= options.rtol;
  return answer;
}

MaxwellMatrix solve_with_insulators(const Scene& scene, const BoundaryElementOptions& options) {
  if (options.derivatives)
    throw InputError("boundary elements know no derivatives in scenes with dielectric bodies");
  detail::InsulatedBodies bodies = detail::insulated_bodies(scene);
  choose_asked(options.entries, bodies.conductors);
  MaxwellMatrix answer = detail::insulated_maxwell(bodies, options);
  answer.reached = largest_error(answer, bodies.conductors) <= options.rtol;
  return answer;
}

}  // namespace

void validate(const BoundaryElementOptions& options) {
  if (!(options.rtol >= strictest_rtol && options.rtol <= loosest_rtol))
    throw InputError(
        fmt::format("rtol {} must be from {} to {}", options.rtol, strictest_rtol, loosest_rtol));
}

MaxwellMatrix maxwell(const Scene& scene, const BoundaryElementOptions& options) {
  validate(options);
  if (scene.has_room)
    throw InputError("room: boundary elements compute only conductors in free space");
  MaxwellMatrix answer = detail::has_insulators(scene) ? solve_with_insulators(scene, options)
                                                       : solve_conductors(scene, options);
  const double factor = 4 * std::numbers::pi * vacuum_permittivity * scene.medium.relative_permittivity;
  answer.values *= factor;
  answer.charges *= factor;
  answer.errors *= factor;
  answer.delta_self *= factor;
  answer.delta_self_errors *= factor;
  for (ReadingAnswer& reading : answer.readings)
    detail::scale(reading, factor);
  return answer;
}

SceneCapacitance capacitance(const Scene& scene, const MaxwellMatrix& matrix, std::string_view answered_by) {
  SceneCapacitance answer;
  for (std::size_t s = 0; s < matrix.sensors; ++s) {
    SensorCapacitance felt{matrix.conductors[s], 0, 0, 0, false, {}};
    Index row = 0;
    for (std::size_t k = 0; k < matrix.conductors.size(); ++k)
      for (const std::string& name : matrix.members[k]) {
        const double charge = matrix.charges(row++, static_cast<Index>(s));
        if (k < matrix.sensors)
          continue;
        felt.objects.push_back({name, matrix.members[k].size() == 1 ? matrix.mutual(s, k) : -charge, 0, false,
                                std::string(answered_by),
                                matrix.errors(static_cast<Index>(s), static_cast<Index>(k))});
        felt.total += felt.objects.back().capacitance;
      }
    felt.voltage = divider_voltage(scene.sensors[s], felt.total);
    felt.delta_voltage = scene.sensors[s].input_voltage - felt.voltage;
    answer.sensors.push_back(std::move(felt));
  }
  return answer;
}

}  // namespace fringe
