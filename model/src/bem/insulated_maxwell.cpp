#include "bem/insulated_maxwell.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "bem/adaptive.hpp"
#include "bem/group_densities.hpp"
#include "bem/insulated_system.hpp"
#include "bem/simplification_effects.hpp"
#include "fringe/error.hpp"
#include "fringe/interruption.hpp"
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

/// Returns the memory that the matrices may take, in bytes.
double most_bytes() {
  constexpr double part_of_memory = 4;
  return static_cast<double>(physical_memory()) / part_of_memory;
}

/// A-priori grading takes part of so many panels.
constexpr std::size_t graded_of = 3000;

/// A-priori grading takes at most one in so many of them.
constexpr std::size_t most_graded_with_insulators = 2;

/// Ratio of the quadratures' tolerance to rtol, and the coarsest tolerance.
constexpr double tolerance_part = 1.0 / 10;
constexpr double coarsest_tolerance = 1e-3;

/// Estimated error of an extrapolated value, per change from the coarse to the whole space.
constexpr double error_per_extrapolated_change = 1;

/// The same for what targets change. With 1 it was exceeded once by a third, by a wet film, among 150 changes
/// that the field solver enclosed.
constexpr double error_of_change_per_extrapolated_change = 1.4;

/// Growth of the error per change, for a change of the energies by all of them: where panels are far too
/// coarse, the next change is not the last one's half. Between two plates whose own entries changed by 19 and
/// 3 %, the error reached 1.7 times the change.
constexpr double growth_by_change = 10;

/// Least error, per energy of what varies within the groups. It is about half of the change between the
/// spaces where panels resolve the layers. Where the potential varies along a layer that is thin beside its
/// panels, the potential's steps stiffen both spaces alike, and only the energy shows it.
constexpr double error_per_missed_energy = 0.5;

/// Factors of the errors of changes in the first two solutions, whose panels may be too coarse to tell what
/// they miss. Of 607 solutions of 51 scenes with slabs, balls and covers, held against finer ones, the
/// estimates were exceeded by up to 7 times in a first solution, 2 times in a second one, nowhere later.
constexpr std::array<double, 2> factors_of_first_solutions{4, 2};

/// Number of refinements that have to use little of the estimated errors before less is stated: one of few
/// panels may leave out where the error is, and then values hardly change (a layer before a sensor, 264
/// panels).
constexpr std::size_t remembered_refinements = 2;

/// Error per energy that undivided triangles would gain from division: values are not extrapolated by it.
constexpr double error_per_undivided_gain = error_per_panel_change;

/// Rows of the roots of an undivided triangle's energy: its quarters.
constexpr Index rows_per_triangle = 4;

/// Part of the effects of the thickness of thin films by which these may be wrong.
constexpr double error_of_film_effects = 0.5;

/// Part of the errors of a value and its background by films in which they differ.
constexpr double unlike_film_effects = 0.1;

/// A symmetric matrix, extrapolated and in both spaces, without floating conductors, and how far from
/// symmetric it was solved.
struct Solved {
  MatrixXd values;
  MatrixXd fine;
  MatrixXd coarse;
  MatrixXd half_refined;  ///< InsulatedSolution::half_refined
  MatrixXd asymmetry;
  MatrixXd films;           ///< effects of the thickness of thin films
  VectorXd missed;          ///< energy that varies within groups, for each conductor at unit potential
  MatrixXd undivided;       ///< of undivided triangles, UndividedGain::roots
  MatrixXd facets;          ///< roots of the errors by those of round shapes
  MatrixXd lasting_facets;  ///< those that no refinement makes less
  MatrixXd simplified;      ///< roots of the errors by simplified surfaces and the ridge, for every panel
};

/// `deviations` are energies of errors per squared charge of each panel.
Solved solved(const InsulatedSolution& solution, const VectorXd& deviations, const ChargedBodies& bodies) {
  const MatrixXd asymmetry = (solution.matrix.fine - solution.matrix.fine.transpose()).cwiseAbs() / 2;
  const MatrixXd values = without_floating(symmetric(solution.extrapolated), bodies);
  const MatrixXd at = potentials(symmetric(solution.matrix.fine), bodies);
  return {values,
          without_floating(symmetric(solution.matrix.fine), bodies),
          without_floating(symmetric(solution.matrix.coarse), bodies),
          without_floating(symmetric(solution.half_refined), bodies),
          asymmetry.topLeftCorner(values.rows(), values.cols()),
          without_floating(symmetric(solution.extrapolated + solution.film_effects), bodies) - values,
          solution.missed_energies.head(values.rows()),
          std::sqrt(error_per_undivided_gain) * solution.undivided * at,
          solution.facets * at,
          solution.lasting_facets * at,
          deviations.cwiseSqrt().asDiagonal() * solution.panels * at};
}

/// Returns the charges of the members: on a conductor of one member its entries, else those in the whole
/// space, which are not extrapolated: smooth charges far from edges have no error left.
MatrixXd charges_of(const Solved& one, const InsulatedSolution& solution, const ChargedBodies& bodies) {
  MatrixXd charges = member_charges(symmetric(solution.matrix.fine), solution.body_charges, bodies);
  Index row = 0;
  for (Index conductor = 0; conductor < one.values.rows(); ++conductor) {
    const auto members = index_of(bodies.conductors[static_cast<std::size_t>(conductor)].members.size());
    if (members == 1)
      charges.row(row) = one.values.row(conductor);
    row += members;
  }
  return charges;
}

/// Returns the errors of all entries by the thickness of thin films.
MatrixXd film_errors_of(const Solved& one) {
  const VectorXd roots = one.films.diagonal().cwiseAbs().cwiseSqrt();
  return error_of_film_effects * roots * roots.transpose();
}

/// Returns the errors of all entries by their roots, in which each conductor has a column.
MatrixXd errors_of_roots(const MatrixXd& errors) {
  const VectorXd roots = errors.colwise().norm();
  return roots * roots.transpose();
}

/// Returns the products of the roots of errors in two columns, those of all panels counted as positive.
double error_between(const VectorXd& first, const VectorXd& second, Index rows) {
  double result = 0;
  for (Index k = 0; k < first.size(); k += rows)
    result += first.segment(k, rows).norm() * second.segment(k, rows).norm();
  return result;
}

/// Returns the errors of readings by their roots, with the targets and without them. Those that are alike in
/// both cancel in the changes.
ReadingEffects errors_of_readings(const MatrixXd& all, const MatrixXd& background, Index rows,
                                  const ChargedBodies& bodies) {
  const Index count = index_of(bodies.readings.size());
  ReadingEffects result{VectorXd(count), VectorXd(count), VectorXd(count)};
  for (Index k = 0; k < count; ++k) {
    const ChargedReading& reading = bodies.readings[static_cast<std::size_t>(k)];
    const VectorXd sense = reading.sense.head(all.cols()), drive = reading.drive.head(all.cols());
    const VectorXd sensed = all * sense, driven = all * drive, sensed_alone = background * sense,
                   driven_alone = background * drive;
    result.value[k] = error_between(sensed, driven, rows);
    result.background[k] = error_between(sensed_alone, driven_alone, rows);
    result.change[k] = error_between(sensed - sensed_alone, driven_alone, rows) +
                       error_between(sensed, driven - driven_alone, rows);
  }
  return result;
}

/// Returns the error of what the objects add to a sensor's own entry.
double error_of_added(const MatrixXd& with, const MatrixXd& without, Index sensor, Index rows) {
  return error_between(with.col(sensor) - without.col(sensor), with.col(sensor) + without.col(sensor), rows);
}

/// Returns the errors of all entries. `believed` is the part of the estimates that is stated, `undivided` is
/// InsulatedSystem::undivided_error().
MatrixXd errors_of(const Solved& one, double believed, double undivided) {
  const VectorXd part = error_per_missed_energy * one.missed.cwiseQuotient(one.fine.diagonal());
  const VectorXd changed = (1 - one.coarse.diagonal().array() / one.fine.diagonal().array()).abs().sqrt();
  const MatrixXd growth =
      MatrixXd::Ones(part.size(), part.size()) + growth_by_change * changed * changed.transpose();
  const MatrixXd least = part.replicate(1, part.size()).cwiseMax(part.transpose().replicate(part.size(), 1));
  return believed * (error_per_extrapolated_change * changes(one.fine, one.coarse))
                        .cwiseMax(least.cwiseProduct(one.values.cwiseAbs()))
                        .cwiseProduct(growth) +
         one.asymmetry + film_errors_of(one) + errors_of_roots(one.undivided) + errors_of_roots(one.facets) +
         errors_of_roots(one.simplified) + undivided * one.values.cwiseAbs();
}

/// Returns the change of a quantity from the coarse to the whole space: that by charges and that by
/// potentials of interfaces, which may have opposite signs, are both counted as positive.
double between_spaces(double coarse, double half_refined, double fine) {
  return std::abs(half_refined - coarse) + std::abs(fine - half_refined);
}

StepsOfChanges steps_of_changes(const Solved& all, const Solved& background, const ChargedBodies& bodies) {
  const Index count = index_of(bodies.readings.size()), kept = all.fine.rows();
  StepsOfChanges result{VectorXd(count), VectorXd(count)};
  for (Index k = 0; k < count; ++k) {
    const ChargedReading& reading = bodies.readings[static_cast<std::size_t>(k)];
    const auto form = [&](const MatrixXd& matrix) {
      return reading.sense.head(kept).dot(matrix * reading.drive.head(kept));
    };
    const double half_refined = form(all.half_refined - background.half_refined);
    result.by_charges[k] = half_refined - form(all.coarse - background.coarse);
    result.by_potentials[k] = form(all.fine - background.fine) - half_refined;
  }
  return result;
}

/// Estimates a quantity and its error. `change` is that from the coarse to the whole space.
Estimate estimate_of(double value, double change, double least_part, double undivided, double other,
                     double error_per_change) {
  return {value, error_per_change * (1 + growth_by_change * least_part) *
                         std::max(change, least_part * std::abs(value)) +
                     undivided * std::abs(value) + other};
}

/// Returns the least error of the energy at some potentials, by what varies within the groups.
double least_error(const VectorXd& potentials, const Solved& one) {
  const double missed = potentials.cwiseAbs().dot(one.missed.cwiseSqrt());
  return error_per_missed_energy * missed * missed;
}

/// Returns the part by which the coarse space errs, for potentials.
double missing_part(const VectorXd& potentials, const Solved& one) {
  const Index kept = one.fine.rows();
  const double fine = potentials.head(kept).dot(one.fine * potentials.head(kept)),
               coarse = potentials.head(kept).dot(one.coarse * potentials.head(kept));
  return fine > 0 ? std::max(std::abs(1 - coarse / fine), least_error(potentials.head(kept), one) / fine) : 0;
}

/// Returns the errors of readings by the thickness of thin films.
ReadingEffects film_errors_of_readings(const Solved& all, const Solved& background,
                                       const ChargedBodies& bodies) {
  const Index count = index_of(bodies.readings.size()), kept = all.fine.rows();
  ReadingEffects result{VectorXd(count), VectorXd(count), VectorXd(count)};
  for (Index k = 0; k < count; ++k) {
    const ChargedReading& reading = bodies.readings[static_cast<std::size_t>(k)];
    const VectorXd sense = reading.sense.head(kept), drive = reading.drive.head(kept);
    // The effects may have either sign off the diagonal.
    const auto error = [&](const MatrixXd& films) {
      return error_of_film_effects * std::sqrt(std::abs(sense.dot(films * sense) * drive.dot(films * drive)));
    };
    result.value[k] = error(all.films);
    result.background[k] = error(background.films);
    // Errors in the same places, as far as the charges are alike.
    result.change[k] = error_of_film_effects * std::abs(sense.dot((all.films - background.films) * drive)) +
                       unlike_film_effects * (result.value[k] + result.background[k]);
  }
  return result;
}

/// `believed` is the part of the estimates that is stated, of those of changes `believed_of_changes`.
std::vector<ReadingAnswer> reading_answers(const Solved& all, const Solved& background, double believed,
                                           double believed_of_changes, double undivided,
                                           const ReadingEffects& others, const ChargedBodies& bodies) {
  const double per_change = believed * error_per_extrapolated_change;
  std::vector<ReadingAnswer> answers;
  const Index kept = all.fine.rows();
  for (const ChargedReading& reading : bodies.readings) {
    const Index at = index_of(answers.size());
    const VectorXd sense = reading.sense.head(kept), drive = reading.drive.head(kept);
    const auto form = [&](const MatrixXd& matrix) { return sense.dot(matrix * drive); };
    const auto absolute_form = [&](const MatrixXd& matrix) { return sense.cwiseAbs().dot(matrix * drive); };
    const double part = std::sqrt(missing_part(sense, all) * missing_part(drive, all));
    const double value = form(all.values), alone = form(background.values);
    const std::array<double, 3> with{form(all.coarse), form(all.half_refined), form(all.fine)},
        without{form(background.coarse), form(background.half_refined), form(background.fine)};
    const double change = between_spaces(with[0], with[1], with[2]);
    const double change_alone = between_spaces(without[0], without[1], without[2]);
    const double change_of_both =
        between_spaces(with[0] - without[0], with[1] - without[1], with[2] - without[2]);
    const double other = absolute_form(all.asymmetry), other_alone = absolute_form(background.asymmetry);
    answers.push_back(
        {reading.name, estimate_of(value, change, part, undivided, other + others.value[at], per_change),
         estimate_of(alone, change_alone, part, undivided, other_alone + others.background[at], per_change),
         estimate_of(value - alone, change_of_both, part, undivided, other + other_alone + others.change[at],
                     believed_of_changes * error_of_change_per_extrapolated_change)});
  }
  return answers;
}

void write_delta_self(const Solved& all, const Solved& alone, double believed, double undivided,
                      MaxwellMatrix& answer) {
  const auto sensors = static_cast<Index>(answer.sensors);
  answer.delta_self.resize(sensors);
  answer.delta_self_errors.resize(sensors);
  for (Index k = 0; k < sensors; ++k) {
    const double added =
        between_spaces(all.coarse(k, k) - alone.coarse(k, k),
                       all.half_refined(k, k) - alone.half_refined(k, k), all.fine(k, k) - alone.fine(k, k));
    const double other = error_of_film_effects * std::abs(all.films(k, k)) +
                         error_of_added(all.undivided, alone.undivided, k, rows_per_triangle) +
                         error_of_added(all.facets, alone.facets, k, BesideFacets::rows) +
                         error_of_added(all.simplified, alone.simplified, k, 1);
    const Estimate change = estimate_of(all.values(k, k) - alone.values(k, k), added,
                                        missing_part(VectorXd::Unit(all.fine.rows(), k), all), undivided,
                                        other, believed * error_of_change_per_extrapolated_change);
    answer.delta_self[k] = *change.value;
    answer.delta_self_errors[k] = *change.error;
  }
}

/// Tells if what is asked for is out of reach, even if errors fall like the third power of the number of
/// panels, as those of changes do at best. Few panels are refined nevertheless, and all a few times: their
/// error says little, and most panels may be those of bodies that hardly matter.
bool is_in_vain(double excess, std::size_t panels, std::size_t most, std::size_t refinements) {
  /// Panels from which on a refinement takes seconds.
  constexpr std::size_t many = 2000;
  constexpr std::size_t few = 3;
  return refinements >= few && panels >= many &&
         std::cbrt(excess) * static_cast<double>(panels) > static_cast<double>(most);
}

/// The Maxwell matrix and the readings of conductors and dielectric bodies.
class InsulatedProblem : public AdaptiveProblem {
 public:
  InsulatedProblem(const InsulatedBodies& bodies, const Simplification& simplification,
                   const BoundaryElementOptions& options)
      : conductors_(bodies.conductors), simplification_(simplification), options_(options),
        system_(bodies, presences(bodies),
                {grading_part * options.rtol,
                 std::min(options.most_unknowns, graded_of) / most_graded_with_insulators},
                options.threads),
        most_(std::min(system_.most_panels(most_bytes()), options.most_unknowns)),
        films_(!bodies.films.empty()), answer_(named_answer(conductors_)) {}

  bool is_too_large() const { return system_.panels() > most_; }

  void refuse_size() const {
    throw InputError(fmt::format(
        "the scene has dielectric bodies and needs at least {} panels: boundary elements take at most {}; a "
        "larger rtol, fewer segments of round bodies or a larger distance between bodies need fewer",
        system_.panels(), most_));
  }

  const std::vector<PanelGroup>& groups() const override { return system_.groups(); }

  Assessment solve() override {
    Solved all, alone, background;
    try {
      system_.evaluate(std::min(tolerance_part * options_.rtol, coarsest_tolerance));
      const VectorXd deviations =
          deviation_effects(simplification_, system_.mesh()) + system_.ridge_effects();
      solution_ = system_.solve(0);
      all = solved(solution_, deviations, conductors_);
      if (answer_.sensors > 0)
        alone = solved(system_.solve(1), deviations, conductors_);
      if (has_readings()) {
        const InsulatedSolution without = system_.solve(2);
        background = solved(without, deviations, conductors_);
        solution_.error_indicators = solution_.error_indicators.cwiseMax(
            system_.change_indicators(solution_, without, steps_of_changes(all, background, conductors_)));
      }
    } catch (const Interrupted&) {
      if (answer_.unknowns == 0)
        throw;
      return {true, {}, 0, 0};
    }
    GeometryErrors geometry =
        errors_by_surfaces(all, background, all.lasting_facets, background.lasting_facets);
    // The error of undivided triangles ends when they are divided; it does not fall with the number of
    // panels.
    GeometryErrors lasting = geometry;
    geometry.are_of_facets = !films_ && !simplification_.is_changed();
    lasting.are_of_facets = true;
    GeometryErrors stated = errors_by_surfaces(all, background, all.facets, background.facets);
    for (GeometryErrors* const each : {&lasting, &stated})
      add_undivided(all, background, *each);
    write(all, alone, background, stated.readings, 1, 1);
    const double believed = believed_.next(answer_, stated.entries, stated.readings, conductors_);
    const double caution =
        refinements_ < factors_of_first_solutions.size() ? factors_of_first_solutions[refinements_] : 1;
    if (believed < 1 || caution > 1)
      write(all, alone, background, stated.readings, believed, caution * believed);
    return assessed(geometry, lasting, caution);
  }

  bool refine(const std::vector<int>& steps) override {
    if (steps.empty())
      return false;
    ++refinements_;
    system_.refine(steps, solution_.panels);
    return true;
  }

  const MaxwellMatrix& answer() const { return answer_; }

 private:
  static std::vector<Presence> presences(const InsulatedBodies& bodies) {
    std::vector<Presence> others{sensors_alone(bodies)};
    if (!bodies.conductors.readings.empty())
      others.push_back(without_targets(bodies));
    return others;
  }

  bool has_readings() const { return !conductors_.readings.empty(); }

  /// Returns the errors by thin films, by facets, of which the roots are given with the targets and without
  /// them, and by simplified surfaces.
  GeometryErrors errors_by_surfaces(const Solved& all, const Solved& background, const MatrixXd& facets,
                                    const MatrixXd& facets_of_background) const {
    GeometryErrors result{
        film_errors_of(all) + errors_of_roots(facets) + errors_of_roots(all.simplified), {}, false};
    if (!has_readings())
      return result;
    result.readings = film_errors_of_readings(all, background, conductors_);
    result.readings += errors_of_readings(facets, facets_of_background, BesideFacets::rows, conductors_);
    result.readings += errors_of_readings(all.simplified, background.simplified, 1, conductors_);
    return result;
  }

  void add_undivided(const Solved& all, const Solved& background, GeometryErrors& errors) const {
    errors.entries += errors_of_roots(all.undivided);
    if (has_readings())
      errors.readings +=
          errors_of_readings(all.undivided, background.undivided, rows_per_triangle, conductors_);
  }

  /// Writes the answer. `believed` is the part of the estimated errors that is stated, of those of changes
  /// `believed_of_changes`; `others` are errors of readings beside them.
  void write(const Solved& all, const Solved& alone, const Solved& background, const ReadingEffects& others,
             double believed, double believed_of_changes) {
    const double undivided = system_.undivided_error();
    answer_.values = all.values;
    answer_.errors = errors_of(all, believed, undivided);
    answer_.charges = charges_of(all, solution_, conductors_);
    answer_.unknowns = system_.panels();
    write_delta_self(all, alone, believed_of_changes, undivided, answer_);
    answer_.readings = has_readings() ? reading_answers(all, background, believed, believed_of_changes,
                                                        undivided, others, conductors_)
                                      : readings_of_sensors(answer_);
  }

  /// `caution` is the factor of the errors of changes; that of a first solution says nothing of how much
  /// refinement they need.
  Assessment assessed(const GeometryErrors& geometry, const GeometryErrors& lasting, double caution) {
    const double excess = excess_error(answer_, conductors_, geometry, options_.rtol);
    if (excess <= 1 || system_.panels() >= most_ ||
        is_in_vain(excess_error(answer_, conductors_, lasting, options_.rtol), system_.panels(), most_,
                   refinements_))
      return {true, {}, 0, 0};
    if (options_.before_refinement)
      options_.before_refinement({answer_.unknowns, excess * options_.rtol});
    const double estimated = std::max(excess / caution, 1.0);
    growth_.measure(estimated, system_.panels());
    return {false, solution_.error_indicators, solution_.error_indicators.sum() / (excess_margin * estimated),
            std::min(growth_.most_added(system_.panels()), most_ - system_.panels()), most_steps_at_once};
  }

  const ChargedBodies& conductors_;
  const Simplification& simplification_;
  const BoundaryElementOptions& options_;
  InsulatedSystem system_;
  std::size_t most_;
  bool films_;
  MaxwellMatrix answer_;
  InsulatedSolution solution_;
  BelievedError believed_{remembered_refinements};
  PanelGrowth growth_;
  std::size_t refinements_ = 0;
};

MaxwellMatrix refined_answer(const InsulatedBodies& bodies, const Simplification& simplification,
                             const BoundaryElementOptions& options) {
  InsulatedProblem problem(bodies, simplification, options);
  if (problem.is_too_large())
    problem.refuse_size();
  solve_adaptively(problem);
  return problem.answer();
}

}  // namespace

std::size_t most_triangles_beside_insulators(const BoundaryElementOptions& options) {
  /// Memory of a pair of a panel and a source of the double layer. As many triangles are kept as could all be
  /// sources: those of conductors are none, which leaves room for refinement.
  constexpr double bytes_per_pair = 32;
  return std::min(static_cast<std::size_t>(std::sqrt(most_bytes() / bytes_per_pair)), options.most_unknowns);
}

MaxwellMatrix insulated_maxwell(const InsulatedBodies& given, const Simplification& simplification,
                                const BoundaryElementOptions& options) {
  const InsulatedBodies bodies = with_few_facets(given);
  const InsulatedBodies with_films = with_thin_films(bodies);
  MaxwellMatrix answer = refined_answer(with_films, simplification, options);
  if (with_films.films.empty() || largest_error(answer, bodies.conductors) <= options.rtol)
    return answer;
  // Panels on both faces resolve the thickness, which the sheet has to first order only.
  try {
    InsulatedProblem other(bodies, simplification, options);
    if (!other.is_too_large()) {
      solve_adaptively(other);
      if (largest_error(other.answer(), bodies.conductors) < largest_error(answer, bodies.conductors))
        return other.answer();
    }
  } catch (const Interrupted&) {
    return answer;
  }
  return answer;
}

}  // namespace fringe::detail
