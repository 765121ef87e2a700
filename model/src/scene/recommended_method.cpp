#include "scene/recommended_method.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "bem/insulators.hpp"
#include "bem/readings.hpp"
#include "correction/company_readings.hpp"
#include "fringe/error.hpp"
#include "fringe/interruption.hpp"
#include "fringe/reading.hpp"
#include "fringe/triangulation.hpp"
#include "numeric/infinity.hpp"

namespace fringe::detail {
namespace {

using Eigen::Index;

/// Largest number of triangles that the reduced method may have to prepare, of all bodies that are neither
/// plates nor boxes: some seconds, once for all poses.
constexpr std::size_t most_prepared_triangles = 4'000;

/// Largest number of bodies with which the reduced method is tried: 100 boxes took more than 11 s of
/// processor time, which grows like the number of pairs.
constexpr std::size_t most_bodies = 30;

/// Largest number of unknowns of boundary elements: a third of a second of processor time for each pose, and
/// 5 s where two bodies almost touch. With 3,000 those took more than 90 s.
constexpr std::size_t most_unknowns = 1'000;

/// Largest stated error, relative, with which a matrix is used that is not as accurate as asked. The mean
/// actual error is a quarter of what is stated, so that beyond this the 2 % (rms) of the formula are no
/// worse.
constexpr double most_unreached_error = 0.1;

/// Returns the number of steps with which the reduced method begins.
int first_steps(double rtol) {
  int steps = 1;
  while (steps < most_reduced_steps && rtol < rtol_of(ReducedOptions{steps, std::nullopt}))
    ++steps;
  return steps;
}

/// Counts the triangles of the objects that are neither plates nor boxes.
std::size_t triangles_to_prepare(const Scene& scene) {
  std::size_t triangles = 0;
  for (const Object& object : scene.objects)
    if (!std::holds_alternative<Plate>(object.shape) && !std::holds_alternative<Cuboid>(object.shape))
      triangles += triangulate(object.shape).size();
  return triangles;
}

/// Tests whether the reduced method takes no more than some seconds. Bodies in contact on different links
/// would take seconds for every pose; they are left to boundary elements, and so are dielectric bodies, which
/// take seconds to prepare and many milliseconds for every pose.
bool reduction_is_bounded(const Scene& scene) {
  if (has_insulators(scene))
    return false;
  std::size_t bodies = scene.objects.size();
  for (const Sensor& sensor : scene.sensors)
    bodies += sensor.plates.size();
  return triangles_to_prepare(scene) <= most_prepared_triangles && bodies <= most_bodies;
}

/// Returns the conductors of electrodes in a matrix; all if there are none.
std::vector<Index> electrodes(const MaxwellMatrix& matrix, const Scene& scene) {
  std::vector<Index> rows, all;
  for (std::size_t k = 0; k < matrix.members.size(); ++k) {
    all.push_back(static_cast<Index>(k));
    const auto object = std::ranges::find(scene.objects, matrix.members[k].front(), &Object::name);
    if (object != scene.objects.end() && std::holds_alternative<Electrode>(object->role))
      rows.push_back(all.back());
  }
  return rows.empty() ? all : rows;
}

/// Returns the larger of two errors; infinity if the second is not a number.
double larger(double largest, double error) {
  if (std::isnan(error))
    return infinity;
  return std::max(largest, error);
}

/// Returns the largest relative error of the entries that tell what is felt: a sensor's own, and those of the
/// objects in its row; without sensors those in the rows of electrodes, relative to what boundary elements
/// refine.
double largest_error_of_entries(const MaxwellMatrix& matrix, const Scene& scene) {
  /// Part of the diagonal entries below which those between electrodes need not be accurate.
  constexpr double least_part = 1e-3;
  double largest = 0;
  const auto add = [&](Index row, Index column, double scale) {
    const double error = matrix.errors(row, column) / scale;
    largest = larger(largest, error);
  };
  const auto sensors = static_cast<Index>(matrix.sensors);
  for (Index sensor = 0; sensor < sensors; ++sensor)
    for (Index other = 0; other < matrix.values.cols(); ++other)
      if (other >= sensors || other == sensor)
        add(sensor, other, std::abs(matrix.values(sensor, other)));
  if (sensors > 0)
    return largest;
  const Eigen::VectorXd roots = matrix.values.diagonal().cwiseAbs().cwiseSqrt();
  for (const Index row : electrodes(matrix, scene))
    for (Index column = 0; column < matrix.values.cols(); ++column)
      add(row, column,
          std::max(std::abs(matrix.values(row, column)), least_part * roots[row] * roots[column]));
  return largest;
}

/// Returns the largest relative error of the entries that tell what is felt; and of the changes of readings,
/// if the scene asks for these. Infinity if one of them is not known, or nothing is known of another entry.
double largest_error(const MaxwellMatrix& matrix, const Scene& scene) {
  if (!matrix.errors.allFinite())
    return infinity;
  double largest = largest_error_of_entries(matrix, scene);
  if (asks_for_changes(scene))
    for (const double error : errors_of_changes(matrix.readings))
      largest = larger(largest, error);
  return largest;
}

/// Returns what an attempt finds, if it is expected to take no longer than what is left of the time, and does
/// not; an interruption from elsewhere passes through.
template <typename Attempt>
auto in_time(const TimeLimit* limit, double expected_seconds, const Attempt& attempt) -> decltype(attempt()) {
  if (limit != nullptr && limit->seconds_left() < expected_seconds)
    return std::nullopt;
  try {
    return attempt();
  } catch (const Interrupted&) {
    if (limit == nullptr || !limit->is_over())
      throw;
    return std::nullopt;
  }
}

/// Returns the largest relative error of the changes; infinity if one of them is not known.
double largest_error_of_changes(const std::vector<ReadingAnswer>& readings) {
  if (std::ranges::any_of(readings,
                          [](const ReadingAnswer& reading) { return !reading.change.error.has_value(); }))
    return infinity;
  double largest = 0;
  for (const double error : errors_of_changes(readings))
    largest = larger(largest, error);
  return largest;
}

/// Tells whether the formula has anything to say of a scene.
bool formula_answers(const Scene& scene) {
  return !scene.sensors.empty() || InsulatedReadings::knows(scene);
}

/// Returns the largest relative error of what the formula answers: of the changes of readings if it knows
/// these, else infinity, unless all its capacitances are certain.
double error_of(const Evaluation& formula) {
  if (!formula.readings.empty())
    return largest_error_of_changes(formula.readings);
  return formula.reached ? 0 : infinity;
}

}  // namespace

RecommendedMethod::RecommendedMethod(double rtol, bool goes_on, std::shared_ptr<LinkPoses> poses)
    : rtol_(rtol), goes_on_(goes_on), poses_(std::move(poses)), company_(poses_), accurate_(poses_) {}

Evaluation RecommendedMethod::evaluate(const Scene& scene, std::optional<double> max_seconds) {
  std::optional<TimeLimit> limited;
  if (max_seconds)
    limited.emplace(*max_seconds);
  TimeLimit* const limit = limited ? &*limited : nullptr;
  refusal_.clear();
  std::optional<Candidate> best =
      in_time(limit, seconds_of_reduced_method(scene), [&] { return by_reduced_method(scene); });
  if (!best || !(best->error <= rtol_))
    if (std::optional<Candidate> other =
            in_time(limit, 0, [&] { return by_boundary_elements(scene, most_unknowns); });
        other && (!best || other->error < best->error))
      best = std::move(other);
  if (goes_on_ && (!best || !(best->error <= rtol_)) && !(limit != nullptr && limit->is_over()))
    if (std::optional<Evaluation> answer = by_going_on(scene, best, limit))
      return *std::move(answer);
  if (best && best->error <= std::max(rtol_, most_unreached_error))
    return answer_of(scene, *std::move(best));
  std::optional<Evaluation> formula;
  std::string refused_by_formula;
  if (formula_answers(scene)) {
    try {
      formula = by_formula(scene, limit);
    } catch (const InputError& error) {
      refused_by_formula = error.what();
    }
  }
  const double of_formula = formula ? error_of(*formula) : infinity;
  if (!goes_on_ && std::isinf(of_formula))
    try_all_unknowns(scene, best, formula.has_value(), limit);
  if (best && std::isfinite(best->error) && best->error <= of_formula)
    return answer_of(scene, *std::move(best));
  if (formula)
    return *std::move(formula);
  throw InputError(refusal(refused_by_formula, max_seconds.value_or(0)));
}

/// Replaces the best matrix by that of all unknowns which boundary elements may have, if this states less.
/// @param is_answered whether there is an answer if it is interrupted
void RecommendedMethod::try_all_unknowns(const Scene& scene, std::optional<Candidate>& best, bool is_answered,
                                         const TimeLimit* limit) {
  try {
    if (std::optional<Candidate> other = in_time(
            limit, 0, [&] { return by_boundary_elements(scene, BoundaryElementOptions{}.most_unknowns); });
        other && (!best || other->error < best->error))
      best = std::move(other);
  } catch (const Interrupted&) {
    if (!best && !is_answered)
      throw;
  }
}

/// Says why no method has an answer.
std::string RecommendedMethod::refusal(const std::string& of_formula, double seconds) const {
  if (refusal_.empty())
    return seconds > 0 ? fmt::format("{:g} s suffice for no method{}", seconds,
                                     of_formula.empty() ? "" : " but the formula: " + of_formula)
                       : "no method knows an error of its answer: the bodies are too close to each other";
  return of_formula.empty() || of_formula == refusal_
             ? refusal_
             : fmt::format("{}; the formula: {}", refusal_, of_formula);
}

/// Tries what takes up to minutes; returns the formula's answer if it states less than the best matrix, which
/// may become that of all unknowns. Nothing if the computation is interrupted before.
std::optional<Evaluation> RecommendedMethod::by_going_on(const Scene& scene, std::optional<Candidate>& best,
                                                         TimeLimit* limit) {
  std::optional<Evaluation> formula;
  try {
    if (InsulatedReadings::knows(scene)) {
      formula = by_formula(scene, limit);
      if (formula)
        if (std::optional<Evaluation> accurate = in_time(limit, seconds_of_accurate_formula(scene), [&] {
              return by_accurate_formula(scene, *formula);
            }))
          formula = std::move(accurate);
      if (formula && formula->reached)
        return formula;
    }
  } catch (const InputError&) {
    // Boundary elements answer where the formula refuses.
    formula.reset();
  }
  try_all_unknowns(scene, best, formula.has_value(), limit);
  if (!formula || (best && best->error <= largest_error_of_changes(formula->readings)))
    return std::nullopt;
  return formula;
}

Evaluation RecommendedMethod::answer_of(const Scene& scene, Candidate candidate) const {
  const bool reached = candidate.matrix.reached = candidate.error <= rtol_;
  SceneCapacitance felt = capacitance(scene, candidate.matrix, candidate.method);
  return {std::move(felt), std::move(candidate.matrix), {}, std::move(candidate.method), reached};
}

/// Estimates the seconds until the reduced method has an answer; 0 if it is prepared or refuses.
double RecommendedMethod::seconds_of_reduced_method(const Scene& scene) const {
  constexpr double seconds_per_triangle = 2e-3;
  return reduced_ || reduced_refuses_
             ? 0
             : seconds_per_triangle * static_cast<double>(triangles_to_prepare(scene));
}

/// Estimates the seconds until the formula in company has an answer to the accuracy; 0 if it is prepared, or
/// files may hold what was. Measured on the machines of model/CORRECTIONS.md, section 8.
double RecommendedMethod::seconds_of_accurate_formula(const Scene& scene) const {
  constexpr double least_seconds = 2, seconds_per_triangle = 5e-3;
  return is_accurate_prepared_ || files_
             ? 0
             : least_seconds + seconds_per_triangle * static_cast<double>(triangles_to_prepare(scene));
}

std::optional<RecommendedMethod::Candidate> RecommendedMethod::by_reduced_method(const Scene& scene) {
  const int steps = first_steps(rtol_);
  try {
    if (!reduced_ && !reduced_refuses_) {
      reduced_refuses_ = true;
      if (!reduction_is_bounded(scene))
        return std::nullopt;
      reduced_.emplace(scene, ReducedOptions{steps, rtol_, ReducedContacts::of_one_link}, poses_);
      reduced_refuses_ = false;
    }
    if (reduced_refuses_)
      return std::nullopt;
    const MaxwellMatrix& matrix = reduced_->maxwell();
    return Candidate{matrix, to_string(Method(Reduced{steps})), largest_error(matrix, scene)};
  } catch (const InputError& error) {
    refusal_ = error.what();
    return std::nullopt;
  } catch (const Interrupted&) {
    // Preparations that an interruption leaves incomplete must not serve the next answer.
    reduced_.reset();
    reduced_refuses_ = false;
    throw;
  }
}

std::optional<RecommendedMethod::Candidate> RecommendedMethod::by_boundary_elements(const Scene& scene,
                                                                                    std::size_t unknowns) {
  try {
    MaxwellMatrix matrix = maxwell(scene, {.rtol = rtol_, .most_unknowns = unknowns});
    const double error = largest_error(matrix, scene);
    return Candidate{std::move(matrix), to_string(Method(BoundaryElements{})), error};
  } catch (const InputError& error) {
    refusal_ = error.what();
    return std::nullopt;
  }
}

/// Answers by the formula in closed form, which gets some seconds even where the time is over; nothing if
/// these do not suffice.
std::optional<Evaluation> RecommendedMethod::by_formula(const Scene& scene, TimeLimit* limit) {
  /// Several times what it takes for machines of some ten thousand triangles.
  constexpr double enough_seconds = 10;
  if (limit != nullptr)
    limit->grant(enough_seconds);
  return in_time(limit, 0, [&]() -> std::optional<Evaluation> {
    try {
      return by_formula(scene);
    } catch (const Interrupted&) {
      // Preparations that an interruption leaves incomplete must not serve the next answer.
      formula_.reset();
      company_ = InsulatedReadings(poses_);
      throw;
    }
  });
}

Evaluation RecommendedMethod::by_formula(const Scene& scene) {
  refuse_thick_covers(scene);
  if (!formula_)
    formula_.emplace(scene, CapacitanceOptions{.correction = Correction::formula}, poses_);
  SceneCapacitance felt = formula_->capacitance();
  bool reached = true;
  for (SensorCapacitance& sensor : felt.sensors)
    for (ObjectCapacitance& object : sensor.objects) {
      // That two conductors in contact have no finite capacitance is certain.
      if (std::isinf(object.capacitance))
        object.error = 0;
      reached = reached && object.error.has_value();
    }
  Evaluation answer{std::move(felt), std::nullopt, {}, to_string(Correction::formula), reached};
  if (InsulatedReadings::knows(scene)) {
    company_.write(scene, answer.readings);
    answer.reached = reached && largest_error_of_changes(answer.readings) <= rtol_;
  }
  return answer;
}

/// Returns the answer with the changes of the formula in company for the accuracy asked for; nothing if the
/// computation is interrupted, or the formula refuses an accuracy.
std::optional<Evaluation> RecommendedMethod::by_accurate_formula(const Scene& scene,
                                                                 const Evaluation& in_closed_form) {
  try {
    Evaluation answer = in_closed_form;
    accurate_.write(scene, answer.readings, rtol_);
    is_accurate_prepared_ = true;
    answer.answered_by = CompanyReadings::name;
    answer.reached = largest_error_of_changes(answer.readings) <= rtol_;
    return answer;
  } catch (const InputError&) {
    return std::nullopt;
  } catch (const Interrupted&) {
    // Preparations that an interruption leaves incomplete must not serve the next answer.
    accurate_ = InsulatedReadings(poses_);
    is_accurate_prepared_ = false;
    accurate_.keep_in(files_);
    return std::nullopt;
  }
}

}  // namespace fringe::detail
