#include "readings/believed_error.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

namespace fringe::detail {
namespace {

using Eigen::Index;

/// Factor by which a refinement may use up more of the estimated errors than the one before, and the least
/// part of them that is stated whatever that used.
constexpr double used_caution = 2, least_used = 0.25;

/// Returns the largest part of an error that turned out to be there: how much a value has changed by a
/// refinement over how much less its estimated error is; 1 if that is not less. Values whose errors cancel by
/// chance do not decide: diagonal entries only grow. An estimated error above the value counts as the value:
/// more cannot have been missing.
double used_part(const std::vector<double>& values_before, const std::vector<double>& errors_before,
                 const std::vector<double>& values, const std::vector<double>& errors) {
  double used = 0;
  for (std::size_t k = 0; k < values.size(); ++k) {
    const double less = std::min(errors_before[k], std::abs(values[k])) - errors[k];
    used = std::max(used, less > 0 ? std::abs(values[k] - values_before[k]) / less : 1);
  }
  return used;
}

}  // namespace

double BelievedError::next(const MaxwellMatrix& answer, const Eigen::MatrixXd& lasting,
                           const ReadingEffects& of_readings, const ChargedBodies& bodies) {
  std::vector<double> values, errors;
  const auto add = [&](double value, double error) {
    values.push_back(value);
    errors.push_back(error);
  };
  for (Index k = 0; k < answer.values.rows(); ++k)
    if (bodies.conductors[static_cast<std::size_t>(k)].is_asked)
      add(answer.values(k, k), answer.errors(k, k) - lasting(k, k));
  for (std::size_t k = 0; k < bodies.readings.size(); ++k) {
    const ReadingAnswer& reading = answer.readings[k];
    const auto at = static_cast<Index>(k);
    add(*reading.value.value, *reading.value.error - of_readings.value[at]);
    add(*reading.change.value, *reading.change.error - of_readings.change[at]);
  }
  if (!values_.empty())
    used_.push_back(used_part(values_, errors_, values, errors));
  values_ = std::move(values);
  errors_ = std::move(errors);
  if (used_.size() < remembered_)
    return 1;
  const auto first = used_.end() - static_cast<std::ptrdiff_t>(remembered_);
  return std::clamp(used_caution * *std::max_element(first, used_.end()), least_used, 1.0);
}

}  // namespace fringe::detail
