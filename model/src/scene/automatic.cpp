#include "scene/automatic.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "fringe/error.hpp"
#include "fringe/interruption.hpp"
#include "numeric/infinity.hpp"

namespace fringe::detail {
namespace {

/// Largest stated error, relative, beyond which the readings before a machine are asked, too: one that is
/// prepared roughly states about as much, one that is prepared for the accuracy less, also beside covers.
constexpr double most_unreached_error = 0.1;

/// Seconds that an answer gets even where the time is over, if there is none yet: several times what a rough
/// preparation of some ten thousand triangles takes.
constexpr double seconds_of_grace = 10;

/// Part of the time limit by which a search for a better answer may exceed it, if the answer so far is bad.
constexpr double part_of_grace = 0.1;

/// Seconds that boundary elements take for an unknown, on two cores of 2020: nine arms of 2,800 to 108,000
/// triangles took 1.4e-4 to 4.8e-4 at 1e-2. They are counted, not measured, so that a motion always has the
/// same answers.
constexpr double seconds_per_unknown = 3e-4;

/// Tells whether an estimate states a smaller error than another one, which may not be known.
bool is_better(const Estimate& one, const Estimate& other) {
  return one.value && one.error && (!other.value || *one.error < other.error.value_or(infinity));
}

/// The best answer so far: the one that states the smallest error. Where one method has a matrix and another
/// knows only readings, it has that matrix and of each reading the best value and change of both.
class Best {
 public:
  Best(const Scene& scene, const EvaluationOptions& asked, TimeLimit* limit)
      : scene_(scene), asked_(asked), limit_(limit) {}

  bool is_done() const { return is_interrupted_ || error_ <= rtol_of(asked_); }
  double error() const { return error_; }
  bool is_late() const { return limit_ != nullptr && limit_->is_over(); }

  /// Asks a method that is expected to take so long, if nothing reached the accuracy and there is time for
  /// it.
  /// @param is_any_use whether it has an answer before that, too
  template <typename Answer>
  void ask(double seconds, bool is_any_use, const Answer& answer) {
    if (is_done() || (limit_ != nullptr && limit_->seconds_left() < (is_any_use ? 0 : seconds)))
      return;
    // A method that answers in vain takes its time, too.
    expected_ += seconds;
    try {
      Evaluation found;
      answer(found);
      found.expected_seconds = expected_;
      take(std::move(found));
    } catch (const InputError& error) {
      if (refusals_.find(error.what()) == std::string::npos)
        refusals_ += (refusals_.empty() ? "" : "; ") + std::string(error.what());
    } catch (const Interrupted&) {
      // An end from elsewhere than the limit of time is that of the whole answer.
      is_interrupted_ = !is_late();
    }
  }

  Evaluation answer() && {
    if (answer_) {
      answer_->reached = error_ <= rtol_of(asked_);
      if (answer_->matrix)
        answer_->matrix->reached = answer_->reached;
      return *std::move(answer_);
    }
    if (is_interrupted_ || is_late() || refusals_.empty())
      throw Interrupted();
    throw InputError(refusals_);
  }

 private:
  void take(Evaluation found) {
    const double error = error_of(found);
    if (!answer_ || answer_->matrix.has_value() == found.matrix.has_value()) {
      if (!answer_ || error < error_) {
        answer_ = std::move(found);
        error_ = error;
      }
      return;
    }
    if (found.matrix)
      std::swap(*answer_, found);
    for (std::size_t k = 0; k < std::min(found.readings.size(), answer_->readings.size()); ++k)
      improve(answer_->readings[k], found.readings[k]);
    answer_->matrix->readings = answer_->readings;
    answer_->expected_seconds = expected_;
    error_ = error_of(*answer_);
  }

  double error_of(const Evaluation& answer) const {
    return answer.reached ? 0 : stated_error(answer, scene_, asked_.entries);
  }

  const Scene& scene_;
  const EvaluationOptions& asked_;
  TimeLimit* limit_;
  std::optional<Evaluation> answer_;
  double error_ = infinity;
  double expected_ = 0;   ///< seconds, of all that were asked
  std::string refusals_;  ///< each once
  bool is_interrupted_ = false;
};

/// What the reduced method is expected to take.
double seconds_of_reduction(const Methods& methods, const SceneSize& size, const EvaluationOptions& asked) {
  return expected_seconds(Reduced{}, size,
                          {.rtol = rtol_of(asked),
                           .is_prepared = methods.is_reduction_prepared(rtol_of(asked), asked.entries),
                           .is_by_matrix = methods.reduces_to_matrix(asked.entries)});
}

double seconds_of_elements(const SceneSize& size, const EvaluationOptions& asked) {
  return expected_seconds(BoundaryElements{}, size, {.rtol = rtol_of(asked)});
}

}  // namespace

void improve(ReadingAnswer& reading, const ReadingAnswer& other) {
  const bool has_value = is_better(other.value, reading.value);
  const bool has_change = is_better(other.change, reading.change);
  if (has_value) {
    reading.value = other.value;
    reading.background = other.background;
  }
  if (has_change) {
    reading.change = other.change;
    reading.derivatives = other.derivatives;
    reading.answered_by = other.answered_by;
  }
  const Estimate &value = reading.value, &change = reading.change;
  // The change of a target in contact is infinite, which leaves the background as it is.
  if (has_value != has_change && value.value && change.value && std::isfinite(*change.value))
    reading.background = {*value.value - *change.value,
                          value.error.value_or(infinity) + change.error.value_or(infinity)};
}

bool Automatic::prefers_reduction(const Methods& methods, const SceneSize& size,
                                  const EvaluationOptions& asked, std::size_t poses) const {
  if (!methods.reduction_is_bounded(asked.entries))
    return false;
  const double by_elements = seconds_of_elements(size, asked);
  return seconds_of_reduction(methods, size, asked) <=
         std::max(static_cast<double>(poses) * by_elements, spent_);
}

Evaluation Automatic::evaluate(Methods& methods, const Scene& scene, const SceneSize& size,
                               const EvaluationOptions& options, bool with_sensors, TimeLimit* limit) {
  EvaluationOptions asked = options;
  asked.rtol = rtol_of(options);
  Best best(scene, asked, limit);
  const double rough_seconds = expected_seconds(Reduced{}, size, {.rtol = rtol_of(asked), .is_rough = true});
  const auto ask_roughly = [&] {
    best.ask(rough_seconds, true, [&](Evaluation& found) {
      methods.reduce_before_machine(scene, asked, true, with_sensors, found);
    });
  };
  const auto ask_reduction = [&] {
    // Bodies in contact on different links would be prepared again in every pose.
    best.ask(seconds_of_reduction(methods, size, asked), false, [&](Evaluation& found) {
      methods.reduce(scene, asked, with_sensors, ReducedContacts::of_one_link, Refinement::none, found);
    });
  };
  // One pose boundary elements answer sooner, as a rule.
  if (methods.may_be_rough(rtol_of(asked), asked.entries) &&
      (methods.is_roughly_prepared() || rough_seconds <= spent_))
    ask_roughly();
  const bool begins_reduced = prefers_reduction(methods, size, asked, 1);
  if (begins_reduced)
    ask_reduction();
  if (!best.is_done()) {
    // Boundary elements answer with what they have when the time is over.
    best.ask(seconds_of_elements(size, asked), true, [&](Evaluation& found) {
      Methods::solve(scene, asked, found);
      spent_ += seconds_per_unknown * static_cast<double>(found.matrix->unknowns);
    });
  }
  if (!begins_reduced && methods.reduction_is_bounded(asked.entries))
    ask_reduction();
  if (!best.is_done() && best.error() > most_unreached_error) {
    const bool is_late = best.is_late();
    if (is_late) {
      const bool is_known = std::isfinite(best.error());
      const double grace = is_known ? part_of_grace * *options.max_seconds : seconds_of_grace;
      if (is_known && methods.has_machine(asked.entries) && rough_seconds > grace)
        return std::move(best).answer();
      limit->grant(grace);
    }
    if (methods.has_machine(asked.entries)) {
      ask_roughly();
      // Where the reduced method answers by a matrix, it has not prepared the machine for the accuracy.
      if (!is_late && methods.reduces_to_matrix(asked.entries) && best.error() > most_unreached_error)
        best.ask(expected_seconds(Reduced{}, size, {.rtol = rtol_of(asked)}), false, [&](Evaluation& found) {
          methods.reduce_before_machine(scene, asked, false, with_sensors, found);
        });
    } else if (!asked.derivatives)
      best.ask(expected_seconds(Formula{}, size, {.rtol = rtol_of(asked)}), true,
               [&](Evaluation& found) { methods.combine(scene, asked, found); });
  }
  return std::move(best).answer();
}

}  // namespace fringe::detail
