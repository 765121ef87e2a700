#include "readings/readings.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "fringe/error.hpp"
#include "fringe/reading.hpp"
#include "readings/maxwell_matrix.hpp"

namespace fringe::detail {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// A matrix without its floating conductors, in both spaces.
NestedMatrix without_floating(const NestedMatrix& matrix, const ChargedBodies& bodies) {
  return {without_floating(matrix.fine, bodies), without_floating(matrix.coarse, bodies)};
}

double form(const VectorXd& sense, const MatrixXd& matrix, const VectorXd& drive) {
  return sense.head(matrix.rows()).dot(matrix * drive.head(matrix.cols()));
}

/// Returns the part of the energy that the coarse space misses, for a vector of potentials.
double missing_part(const VectorXd& potentials, const NestedMatrix& matrix) {
  const double whole = form(potentials, matrix.fine, potentials);
  return whole > 0 ? std::max(1 - form(potentials, matrix.coarse, potentials) / whole, 0.0) : 0;
}

}  // namespace

MatrixXd ReadingCharges::all() const {
  MatrixXd result(sense_change.rows(), 4 * sense_change.cols());
  result << sense_background, sense_change, drive_background, drive_change;
  return result;
}

ReadingCharges reading_charges(const MatrixXd& charges, const MatrixXd& matrix,
                               const MatrixXd& background_charges, const MatrixXd& background,
                               const ChargedBodies& bodies) {
  const MatrixXd with = potentials(matrix, bodies), without = potentials(background, bodies);
  const Index kept = with.cols(), readings = static_cast<Index>(bodies.readings.size());
  MatrixXd sense(kept, readings), drive(kept, readings);
  for (Index k = 0; k < readings; ++k) {
    sense.col(k) = bodies.readings[static_cast<std::size_t>(k)].sense.head(kept);
    drive.col(k) = bodies.readings[static_cast<std::size_t>(k)].drive.head(kept);
  }
  ReadingCharges result{background_charges * (without * sense), charges * (with * sense),
                        background_charges * (without * drive), charges * (with * drive)};
  result.sense_change -= result.sense_background;
  result.drive_change -= result.drive_background;
  return result;
}

double largest_part_of_change(const Eigen::RowVectorXd& roots, const VectorXd& scales) {
  const Index readings = scales.size();
  double largest = 0;
  for (Index k = 0; k < readings; ++k) {
    const double sense = roots[k], sense_change = roots[readings + k];
    const double drive = roots[2 * readings + k], drive_change = roots[3 * readings + k];
    const double change = sense * drive_change + sense_change * drive + sense_change * drive_change;
    largest = std::max(largest, change / scales[k]);
  }
  return largest;
}

ReadingEffects& ReadingEffects::operator+=(const ReadingEffects& other) {
  value += other.value;
  background += other.background;
  change += other.change;
  return *this;
}

ReadingEffects signed_reading_effects(const MatrixXd& form) {
  const Index readings = form.rows() / 4;
  const auto diagonal = [&](Index row, Index column) {
    return form.block(row * readings, column * readings, readings, readings).diagonal().eval();
  };
  ReadingEffects result;
  result.background = diagonal(0, 2);
  result.change = diagonal(0, 3) + diagonal(1, 2) + diagonal(1, 3);
  result.value = result.background + result.change;
  return result;
}

ReadingEffects reading_effects(const MatrixXd& form) {
  return signed_reading_effects(form.cwiseAbs());
}

ReadingEffects reading_effects(const MatrixXd& of_values, const MatrixXd& of_background,
                               const MatrixXd& of_changes, const ChargedBodies& bodies) {
  const auto count = static_cast<Index>(bodies.readings.size());
  ReadingEffects result{VectorXd(count), VectorXd(count), VectorXd(count)};
  for (Index k = 0; k < count; ++k) {
    const auto& [name, sense, drive] = bodies.readings[static_cast<std::size_t>(k)];
    result.value[k] = form(sense.cwiseAbs(), of_values, drive);
    result.background[k] = form(sense.cwiseAbs(), of_background, drive);
    result.change[k] = form(sense.cwiseAbs(), of_changes, drive);
  }
  return result;
}

double change_scale(double value, double change) {
  /// Electronics do not resolve less than this part of the value.
  constexpr double least_part = 1e-5;
  return std::max(std::abs(change), least_part * std::abs(value));
}

VectorXd change_scales(const std::vector<ReadingAnswer>& readings) {
  VectorXd scales(static_cast<Index>(readings.size()));
  for (std::size_t k = 0; k < readings.size(); ++k)
    scales[static_cast<Index>(k)] =
        change_scale(readings[k].value.value.value_or(0), readings[k].change.value.value_or(0));
  return scales;
}

VectorXd errors_of_changes(const std::vector<ReadingAnswer>& readings) {
  VectorXd errors(static_cast<Index>(readings.size()));
  for (std::size_t k = 0; k < readings.size(); ++k)
    errors[static_cast<Index>(k)] = readings[k].change.error.value_or(0);
  return errors.cwiseQuotient(change_scales(readings));
}

VectorXd change_scales(const NestedMatrix& all, const NestedMatrix& background, const ChargedBodies& bodies) {
  const MatrixXd with = without_floating(all.fine, bodies),
                 without = without_floating(background.fine, bodies);
  VectorXd scales(static_cast<Index>(bodies.readings.size()));
  for (Index k = 0; k < scales.size(); ++k) {
    const auto& [name, sense, drive] = bodies.readings[static_cast<std::size_t>(k)];
    const double value = form(sense, with, drive);
    scales[k] = change_scale(value, value - form(sense, without, drive));
  }
  return scales;
}

std::vector<ReadingAnswer> reading_answers(const NestedMatrix& all, const NestedMatrix& background,
                                           double per_change, const ReadingEffects& details,
                                           const ReadingEffects& others, double negligible_part,
                                           const ChargedBodies& bodies) {
  const NestedMatrix with = without_floating(all, bodies), without = without_floating(background, bodies);
  std::vector<ReadingAnswer> answers;
  for (std::size_t k = 0; k < bodies.readings.size(); ++k) {
    const auto& [name, sense, drive] = bodies.readings[k];
    const auto at = static_cast<Index>(k);
    const bool is_energy = sense == drive;
    const double value = form(sense, with.fine, drive), alone = form(sense, without.fine, drive);
    const double added = value - form(sense, with.coarse, drive);
    const double added_alone = alone - form(sense, without.coarse, drive);
    // Two errors of an entry off the diagonal, or of value and background, may cancel by chance.
    const double part = std::sqrt(missing_part(sense, with) * missing_part(drive, with));
    const auto estimate = [&](double quantity, double difference, double other, bool may_be_bound) {
      const double error = per_change * std::max(std::abs(difference), part * std::abs(quantity)) + other;
      Estimate result{quantity, error};
      if (may_be_bound && other <= negligible_part * error)
        result.lower = quantity;
      return result;
    };
    const double added_change = std::max(std::abs(added - added_alone), details.change[at]);
    answers.push_back({name, estimate(value, added, others.value[at], is_energy),
                       estimate(alone, added_alone, others.background[at], is_energy),
                       estimate(value - alone, added_change, others.change[at], false)});
  }
  return answers;
}

void scale(ReadingAnswer& answer, double factor) {
  for (Estimate* const estimate : {&answer.value, &answer.background, &answer.change})
    for (std::optional<double>* const number :
         {&estimate->value, &estimate->error, &estimate->lower, &estimate->upper})
      if (number->has_value())
        **number *= factor;
  for (LinkDerivatives& of_link : answer.derivatives) {
    of_link.change *= factor;
    if (of_link.error)
      *of_link.error *= factor;
  }
}

}  // namespace fringe::detail
