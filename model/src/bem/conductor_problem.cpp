#include "bem/conductor_problem.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "bem/adaptive.hpp"
#include "bem/group_densities.hpp"
#include "bem/jacobi_basis.hpp"
#include "bem/mesh_size.hpp"
#include "bem/panel_system.hpp"
#include "bem/simplification_effects.hpp"
#include "fringe/error.hpp"
#include "fringe/interruption.hpp"
#include "numeric/infinity.hpp"
#include "numeric/memory.hpp"
#include "readings/asked_error.hpp"
#include "readings/believed_error.hpp"
#include "readings/matrix_readings.hpp"
#include "readings/maxwell_matrix.hpp"
#include "readings/readings.hpp"

namespace fringe::detail {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Part of rtol above which simplified surfaces cost too much.
constexpr double too_simple = 0.5;

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

/// Fraction of rtol that the quadrature errors may take, and of the other errors up to which they leave a
/// lower bound one.
constexpr double quadrature_part = 0.1, negligible_part = 0.05;

/// Factor by which one refinement reduces the error at most. While the error exceeds what is allowed by more,
/// quadratures as fine as those of the last step would be in vain.
constexpr double most_excess_in_a_step = 10;

/// Fraction of rtol at which the conjugate gradients for the panels' charges stop. The error indicators of
/// groups, small parts of the energy, have to be known, too.
constexpr double iteration_share = 0.005;

/// Largest ridge on the panels' diagonal, relative to rtol, and at all. Its effect, which is stated, is far
/// smaller: panels by themselves have a small part of the energy.
constexpr double ridge_per_rtol = 10, most_ridge = 0.1;

/// Assumed change of a reading, as a part of its value, before it is known.
constexpr double first_change_part = 1e-2;

/// Returns the possible effect of the quadrature errors on the first conductors' entries.
template <class Solution>
MatrixXd quadrature_errors(const Solution& solution, double tolerance, Index conductors) {
  return quadrature_caution * tolerance * solution.quadrature_effect.topLeftCorner(conductors, conductors);
}

/// Effects of simplified surfaces and of facets on the entries, and between the columns of
/// ReadingCharges::all().
struct EffectsOfSurfaces {
  SurfaceEffects entries;
  SurfaceEffects readings;
  bool is_within = true;  ///< whether the surfaces lie within the bodies
};

EffectsOfSurfaces effects_of_surfaces(const Simplification& simplification, const PanelSystem& system,
                                      const PanelSolution& solution, const ChargedBodies& bodies) {
  return {surface_effects(simplification, system.mesh(),
                          solution.charges * potentials(solution.all.fine, bodies)),
          surface_effects(simplification, system.mesh(), solution.reading_charges),
          simplification.is_within()};
}

/// Adds effects on the conductors' charges to those of their members, in proportion to these.
void add_to_charges(const MatrixXd& effects, MaxwellMatrix& answer) {
  Index first = 0;
  for (Index conductor = 0; conductor < effects.rows(); ++conductor) {
    const auto members = static_cast<Index>(answer.members[static_cast<std::size_t>(conductor)].size());
    auto charges = answer.charges.middleRows(first, members);
    for (Index c = 0; c < effects.cols(); ++c)
      if (const double sum = charges.col(c).cwiseAbs().sum(); sum > 0)
        charges.col(c) += effects(conductor, c) / sum * charges.col(c).cwiseAbs();
    first += members;
  }
}

/// Writes the matrix and its estimated errors to the answer, in metres (to be multiplied by 4πε).
void write_solution(const PanelSolution& solution, const ChargedBodies& bodies, double per_change,
                    double tolerance, const EffectsOfSurfaces& surfaces, MaxwellMatrix& answer) {
  const MatrixXd fine = without_floating(solution.all.fine, bodies);
  const MatrixXd coarse = without_floating(solution.all.coarse, bodies);
  const Index conductors = fine.rows();
  const MatrixXd quadrature = quadrature_errors(solution, tolerance, conductors);
  answer.values = fine + surfaces.entries.facets;
  answer.charges = member_charges(solution.all.fine, solution.body_charges, bodies);
  if (!surfaces.entries.facets.isZero(0))
    add_to_charges(surfaces.entries.facets, answer);
  const MatrixXd own = per_change * changes(fine, coarse) + quadrature +
                       solution.iteration_error.topLeftCorner(conductors, conductors) +
                       solution.ridge_effect + surfaces.entries.facet_errors;
  answer.errors = own + surfaces.entries.lasting_errors;
  answer.lower_bounds.resize(static_cast<std::size_t>(conductors));
  for (Index i = 0; i < conductors; ++i)
    answer.lower_bounds[static_cast<std::size_t>(i)] = surfaces.is_within &&
                                                       surfaces.entries.facets(i, i) == 0 &&
                                                       quadrature(i, i) <= negligible_part * own(i, i);
}

/// Writes the readings, in metres.
void write_readings(const PanelSolution& solution, const ChargedBodies& bodies, double per_change,
                    double tolerance, const EffectsOfSurfaces& surfaces, MaxwellMatrix& answer) {
  if (bodies.readings.empty())
    return;
  ReadingEffects others =
      reading_effects(quadrature_caution * tolerance * solution.reading_quadrature_effect);
  others += reading_effects(solution.iteration_error, solution.background_iteration_error,
                            solution.change_iteration_error, bodies);
  answer.readings = reading_answers(solution.all, solution.background, per_change,
                                    reading_effects(solution.reading_details), others,
                                    surfaces.is_within ? negligible_part : 0, bodies);
  const ReadingEffects added = signed_reading_effects(surfaces.readings.facets);
  ReadingEffects errors = reading_effects(solution.reading_ridge_effect);
  errors += reading_effects(surfaces.readings.facet_errors);
  errors += reading_effects(surfaces.readings.lasting_errors);
  for (std::size_t k = 0; k < answer.readings.size(); ++k) {
    ReadingAnswer& reading = answer.readings[k];
    const auto at = static_cast<Index>(k);
    // A lower bound stays that of the surfaces within the bodies.
    *reading.value.value += added.value[at];
    *reading.background.value += added.background[at];
    *reading.change.value += added.change[at];
    *reading.value.error += errors.value[at];
    *reading.background.error += errors.background[at];
    *reading.change.error += errors.change[at];
  }
}

/// Writes that nothing is known about what the objects add to the sensors' own entries.
void write_no_delta_self(MaxwellMatrix& answer) {
  const auto sensors = static_cast<Index>(answer.sensors);
  answer.delta_self = VectorXd::Zero(sensors);
  answer.delta_self_errors = VectorXd::Constant(sensors, infinity);
}

/// Writes what the objects add to the sensors' own entries, in metres. The errors at a sensor's edges, which
/// are the same without the objects, cancel in this difference.
void write_delta_self(const PanelSystem& system, const PanelSolution& solution, const ChargedBodies& bodies,
                      double per_change, double tolerance, double accuracy, const EffectsOfSurfaces& surfaces,
                      MaxwellMatrix& answer) {
  const auto sensors = static_cast<Index>(answer.sensors);
  SensorsAlone alone = solution.sensors;
  if (sensors_have_panels(bodies)) {
    try {
      alone = system.solve_sensors(accuracy);
    } catch (const Interrupted&) {
      write_no_delta_self(answer);
      return;
    }
  }
  const VectorXd alone_fine = alone.matrix.fine.diagonal().head(sensors),
                 alone_coarse = alone.matrix.coarse.diagonal().head(sensors);
  const VectorXd others =
      quadrature_errors(solution, tolerance, sensors).diagonal() +
      solution.iteration_error.diagonal().head(sensors) + solution.ridge_effect.diagonal().head(sensors) +
      (surfaces.entries.facet_errors + surfaces.entries.lasting_errors).diagonal().head(sensors) +
      quadrature_errors(alone, tolerance, sensors).diagonal() +
      alone.iteration_error.diagonal().head(sensors);
  const VectorXd fine = answer.values.diagonal().head(sensors);
  const VectorXd coarse = without_floating(solution.all.coarse, bodies).diagonal().head(sensors);
  answer.delta_self = fine - alone_fine;
  const VectorXd change =
      answer.delta_self - surfaces.entries.facets.diagonal().head(sensors) - (coarse - alone_coarse);
  const VectorXd relative = 1 - coarse.array() / fine.array();
  answer.delta_self_errors =
      per_change * change.cwiseAbs().cwiseMax(relative.cwiseProduct(answer.delta_self).cwiseAbs()) + others;
}

/// Returns the energy in the highest functions of all faces.
double highest_energy(const PanelSolution& solution) {
  double total = 0;
  for (const Eigen::Vector2d& highest : solution.highest)
    total += highest.sum();
  return total;
}

/// Returns the missing energy that is allowed after a refinement. The energy that is missing now is estimated
/// by that of the highest functions and of the groups of panels.
double allowed_energy(const PanelSolution& solution, double excess) {
  return (solution.error_indicators.sum() + highest_energy(solution)) / (excess_margin * excess);
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
    if (!(energy > allowed) || count == most_functions)
      return;
    const double growth = std::min(std::pow(energy / allowed, 1 / power), most_growth);
    // The nearest odd number.
    const int wanted = 2 * static_cast<int>(growth * count / 2) + 1;
    count = std::min(std::max(wanted, count + 2), most_functions);
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

bool has_most(const FaceFunctions& face) {
  return face.u == most_functions || face.v == most_functions;
}

/// The functions to begin with, those that all features would take, and the estimated errors per change
/// between the two spaces that go with the former, for what functions and what panels miss.
struct Beginning {
  std::vector<FaceFunctions> functions;
  std::vector<FaceFunctions> needed;
  double of_functions;
  double of_panels = error_per_panel_change;
};

Beginning beginning(const ChargedBodies& bodies, std::size_t panels, const BoundaryElementOptions& options) {
  const int least = options.rtol >= 0.01 ? 5 : 7;
  const double features = options.rtol > every_feature ? 1 : 2;
  const std::vector<FaceFunctions> needed = a_priori_functions(bodies, features, least);
  Beginning result{needed, needed, options.rtol > every_feature ? error_per_coarse_change : error_per_change};
  if (count_unknowns(needed) + panels > options.most_unknowns)
    result = {a_priori_functions(bodies, 0, least), needed, error_per_unresolved_change,
              error_per_unresolved_change};
  if (count_unknowns(result.functions) + panels > options.most_unknowns)
    throw InputError(fmt::format("the scene needs at least {} unknowns: boundary elements take at most {}",
                                 count_unknowns(result.functions) + panels, options.most_unknowns));
  return result;
}

/// Returns the smallest change of a reading, as a part of its value.
double smallest_part(const std::vector<ReadingAnswer>& readings) {
  double smallest = 1;
  for (const ReadingAnswer& reading : readings) {
    const double value = reading.value.value.value_or(0), change = reading.change.value.value_or(0);
    if (value != 0)
      smallest = std::min(smallest, change_scale(value, change) / std::abs(value));
  }
  return smallest;
}

/// Returns the largest effect of quadrature errors relative to what is asked for, for a unit error.
double quadrature_excess(const PanelSolution& solution, const ChargedBodies& bodies,
                         const MaxwellMatrix& answer) {
  double excess =
      (solution.quadrature_effect.topLeftCorner(answer.values.rows(), answer.values.cols()).array() /
       error_scales(answer.values, bodies))
          .maxCoeff();
  if (bodies.readings.empty())
    return excess;
  const ReadingEffects effects = reading_effects(solution.reading_quadrature_effect);
  return std::max(
      {excess, effects.value.cwiseQuotient(value_scales(answer, bodies)).maxCoeff(),
       effects.change.cwiseQuotient(change_scales(solution.all, solution.background, bodies)).maxCoeff()});
}

/// The Maxwell matrix and the readings of conductors, in metres (to be multiplied by 4πε).
class ConductorProblem : public AdaptiveProblem {
 public:
  /// Gives up if `may_give_up` and surfaces that may be simplified less cost too much.
  ConductorProblem(const ChargedBodies& bodies, const Simplification& simplification, bool may_give_up,
                   const BoundaryElementOptions& options)
      : bodies_(bodies), simplification_(simplification), may_give_up_(may_give_up), options_(options),
        system_(bodies,
                {grading_part * options.rtol,
                 std::min(options.most_unknowns / most_graded_part, most_graded_panels)},
                options.threads),
        begun_(beginning(bodies, panels(), options)), tolerance_(options.rtol / first_tolerance_part),
        answer_(named_answer(bodies)), change_part_(bodies.readings.empty() ? 1 : first_change_part) {}

  const std::vector<PanelGroup>& groups() const override { return system_.mesh().groups(); }

  Assessment solve() override {
    try {
      // An interruption leaves the solution before.
      solution_ = system_.solve_definite(begun_.functions, tolerance_, iteration_share * options_.rtol,
                                         std::min(ridge_per_rtol * options_.rtol, most_ridge), change_part_);
    } catch (const Interrupted&) {
      if (answer_.unknowns == 0)
        throw;
      is_interrupted_ = true;
      return last();
    }
    surfaces_ = effects_of_surfaces(simplification_, system_, solution_, bodies_);
    const double per_change = weighted_error_per_change();
    write(per_change);
    // The estimates stay as cautious as the last ones turned out to be.
    const bool is_first = answer_.unknowns == 0;
    const double believed = believed_.next(answer_, surfaces_.entries.lasting_errors,
                                           reading_effects(surfaces_.readings.lasting_errors), bodies_);
    if (panels() > 0 && !is_first)
      write(per_change * believed);
    answer_.unknowns = count_unknowns(begun_.functions) + panels();
    if (!bodies_.readings.empty())
      change_part_ = smallest_part(answer_.readings);
    const GeometryErrors geometry{surfaces_.entries.lasting_errors,
                                  reading_effects(surfaces_.readings.lasting_errors),
                                  !simplification_.is_changed()};
    has_given_up_ = may_give_up_ && simplification_.is_changed() &&
                    largest_geometry_error(answer_, bodies_, geometry) > too_simple * options_.rtol;
    excess_ = excess_error(answer_, bodies_, geometry, options_.rtol);
    growth_.measure(excess_, answer_.unknowns);
    if (has_given_up_ || excess_ <= 1 || progress_.is_in_vain(excess_, answer_.unknowns))
      return last();
    if (options_.before_refinement)
      options_.before_refinement({answer_.unknowns, excess_ * options_.rtol});
    return assessed();
  }

  bool refine(const std::vector<int>& steps) override {
    bool is_refined = tighten();
    std::vector<FaceFunctions> more = begun_.functions;
    if (add_functions(solution_, allowed(), excess_, more) &&
        count_unknowns(more) + panels() <= most_unknowns()) {
      begun_.functions = std::move(more);
      is_refined = true;
    }
    if (!steps.empty()) {
      system_.refine_groups(steps, solution_.charges);
      is_refined = true;
    }
    return is_refined;
  }

  /// Returns the answer; none if the problem has given up. Derivatives with respect to the poses are found if
  /// there are any; null: none.
  std::optional<MaxwellMatrix> answer(const LinkPoses* poses) {
    if (has_given_up_)
      return std::nullopt;
    if (poses != nullptr && !is_interrupted_)
      try {
        write_derivatives(charge_nodes(system_, solution_, bodies_), bodies_, *poses, options_.threads,
                          answer_.readings);
      } catch (const Interrupted&) {
        // The readings are known without them.
      }
    const double widened = widen_unreached();
    // An interrupted solution is that of an earlier mesh.
    if (is_interrupted_ && sensors_have_panels(bodies_))
      write_no_delta_self(answer_);
    else
      write_delta_self(system_, solution_, bodies_, per_change_, tolerance_, iteration_share * options_.rtol,
                       surfaces_, answer_);
    answer_.delta_self_errors *= widened;
    if (bodies_.readings.empty())
      answer_.readings = readings_of_sensors(answer_);
    return std::move(answer_);
  }

  /// Returns RefinedMaxwell::needs_panels.
  std::vector<bool> needs_panels() const {
    std::vector<bool> result;
    std::size_t face = 0;
    for (const ChargedBody& body : bodies_.bodies) {
      bool needs = false;
      for (const std::size_t end = face + faces_of(body.surface).size(); face < end; ++face)
        needs = needs || has_most(begun_.functions[face]) || has_most(begun_.needed[face]);
      result.push_back(needs);
    }
    return result;
  }

 private:
  static Assessment last() { return {true, {}, 0, 0}; }

  std::size_t panels() const { return system_.mesh().panels().size(); }

  /// Returns the estimated error per change between the two spaces: that of what functions and of what panels
  /// miss, by their parts of the missing energy.
  double weighted_error_per_change() const {
    const double functions = highest_energy(solution_), groups = solution_.error_indicators.sum();
    if (functions + groups == 0)
      return panels() > 0 ? begun_.of_panels : begun_.of_functions;
    return (begun_.of_functions * functions + begun_.of_panels * groups) / (functions + groups);
  }

  void write(double per_change) {
    per_change_ = per_change;
    write_solution(solution_, bodies_, per_change, tolerance_, surfaces_, answer_);
    write_readings(solution_, bodies_, per_change, tolerance_, surfaces_, answer_);
  }

  /// Widens the errors of values and entries if those of changes show that they are too small, and returns by
  /// what factor. Before a gap that is narrower than the panels, two spaces agree that both miss its charge;
  /// the error of a change also counts what the panels' parts would carry by themselves.
  double widen_unreached() {
    double factor = 1;
    for (std::size_t k = 0; k < answer_.readings.size(); ++k) {
      const auto& [name, sense, drive] = bodies_.readings[k];
      ReadingAnswer& reading = answer_.readings[k];
      const double of_change = *reading.change.error;
      // Only where a conductor is driven and sensed itself is the change a part of the value.
      if (sense != drive ||
          of_change <= options_.rtol * change_scale(*reading.value.value, *reading.change.value))
        continue;
      const double least = *reading.background.error + of_change;
      if (*reading.value.error > 0)
        factor = std::max(factor, least / *reading.value.error);
      reading.value.error = std::max(*reading.value.error, least);
    }
    answer_.errors *= factor;
    return factor;
  }

  /// Returns the number of unknowns at which refinement stops. Beside the matrix there are the one before it,
  /// the one of the coarse space and the preconditioners of both.
  std::size_t most_unknowns() const {
    constexpr std::size_t part_of_memory = 4;
    if (panels() == 0)
      return options_.most_unknowns;
    const std::size_t bytes_per_panel = 1 + system_.panel_operator().matrix().bytes() / panels();
    return std::min(options_.most_unknowns, physical_memory() / part_of_memory / bytes_per_panel);
  }

  /// Returns the energy that faces, and panels if there are any, may miss each after a refinement.
  double allowed() const { return allowed_energy(solution_, excess_) / (panels() == 0 ? 1 : 2); }

  Assessment assessed() const {
    if (panels() == 0)
      return {false, {}, 0, 0};
    const std::size_t most = most_unknowns(), left = most - std::min(answer_.unknowns, most);
    return {false, solution_.error_indicators, allowed(), std::min(growth_.most_added(panels()), left),
            most_steps_at_once};
  }

  /// Makes the quadratures finer if their errors matter. Their possible effect grows with the charges,
  /// without limit near contact.
  bool tighten() {
    const double quadrature =
        quadrature_caution * tolerance_ * quadrature_excess(solution_, bodies_, answer_);
    const double allowed = quadrature_part * options_.rtol * std::max(excess_ / most_excess_in_a_step, 1.0);
    if (quadrature <= allowed)
      return false;
    tolerance_ *= allowed / quadrature / 2;
    return true;
  }

  const ChargedBodies& bodies_;
  const Simplification& simplification_;
  bool may_give_up_;
  const BoundaryElementOptions& options_;
  PanelSystem system_;
  Beginning begun_;
  double tolerance_;  ///< of the quadratures
  MaxwellMatrix answer_;
  PanelSolution solution_;
  EffectsOfSurfaces surfaces_;
  BelievedError believed_{1};
  double per_change_ = 0;  ///< the estimated error per change between the two spaces
  Progress progress_;
  PanelGrowth growth_;
  double change_part_;  ///< the smallest change of a reading, as a part of its value
  double excess_ = 0;   ///< the error over what is allowed
  bool is_interrupted_ = false;
  bool has_given_up_ = false;
};

}  // namespace

std::optional<RefinedMaxwell> refined_maxwell(const ChargedBodies& bodies,
                                              const Simplification& simplification, bool may_give_up,
                                              const BoundaryElementOptions& options, const LinkPoses* poses) {
  ConductorProblem problem(bodies, simplification, may_give_up, options);
  solve_adaptively(problem);
  std::optional<MaxwellMatrix> matrix = problem.answer(poses);
  if (!matrix)
    return std::nullopt;
  return RefinedMaxwell{*std::move(matrix), problem.needs_panels()};
}

}  // namespace fringe::detail
