#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "fringe/reading_answer.hpp"
#include "readings/maxwell_matrix.hpp"
#include "surface/bodies.hpp"

/// Readings by the matrices with and without the targets, in metres (model/BOUNDARY_ELEMENTS.md, section 11).
namespace fringe::detail {

/// The charges that belong to readings (columns): without the targets, and what the targets change, for the
/// sensed conductor at unit potential and for the driven ones.
struct ReadingCharges {
  Eigen::MatrixXd sense_background;
  Eigen::MatrixXd sense_change;
  Eigen::MatrixXd drive_background;
  Eigen::MatrixXd drive_change;

  /// Returns all columns beside each other.
  Eigen::MatrixXd all() const;
};

/// Returns the charges of the readings from those of every conductor at unit potential, with the targets and
/// without them, and from the matrices of both.
ReadingCharges reading_charges(const Eigen::MatrixXd& charges, const Eigen::MatrixXd& matrix,
                               const Eigen::MatrixXd& background_charges, const Eigen::MatrixXd& background,
                               const ChargedBodies& bodies);

/// Returns the largest part of its energy that a reading's change has in one function, relative to `scales`.
/// `roots` are the roots of the function's energies in the columns of ReadingCharges::all().
double largest_part_of_change(const Eigen::RowVectorXd& roots, const Eigen::VectorXd& scales);

/// A symmetric form of the charges, such as an energy or the effect of errors, for each reading's value,
/// background and change.
struct ReadingEffects {
  Eigen::VectorXd value;
  Eigen::VectorXd background;
  Eigen::VectorXd change;

  ReadingEffects& operator+=(const ReadingEffects& other);
};

/// Returns the effects for a form that is given for all columns of ReadingCharges::all().
ReadingEffects signed_reading_effects(const Eigen::MatrixXd& form);

/// Returns the same with all elements of the form counted as positive.
ReadingEffects reading_effects(const Eigen::MatrixXd& form);

/// Returns the effects for forms that are given for the conductors that are not floating, such as errors that
/// values, backgrounds and changes have independently of each other.
ReadingEffects reading_effects(const Eigen::MatrixXd& of_values, const Eigen::MatrixXd& of_background,
                               const Eigen::MatrixXd& of_changes, const ChargedBodies& bodies);

/// Returns what the error of a change is relative to: the change, or a small part of the value where that is
/// larger.
double change_scale(double value, double change);

/// Returns change_scale() of every reading.
Eigen::VectorXd change_scales(const std::vector<ReadingAnswer>& readings);

/// Returns the error of every reading's change, relative to change_scale().
Eigen::VectorXd errors_of_changes(const std::vector<ReadingAnswer>& readings);

/// Returns change_scale() of every reading (m), in the whole space.
Eigen::VectorXd change_scales(const NestedMatrix& all, const NestedMatrix& background,
                              const ChargedBodies& bodies);

/// Returns the answers, in metres. `per_change` is the error per change from the coarse to the whole space;
/// `details` are the energies of the charges beyond the coarse space, which bound what a change may miss
/// where the errors of value and background cancel by chance; `others` are errors of other kinds; a value is
/// a lower bound if its other errors are below `negligible_part` of all.
std::vector<ReadingAnswer> reading_answers(const NestedMatrix& all, const NestedMatrix& background,
                                           double per_change, const ReadingEffects& details,
                                           const ReadingEffects& others, double negligible_part,
                                           const ChargedBodies& bodies);

/// Multiplies all values of an answer.
void scale(ReadingAnswer& answer, double factor);

}  // namespace fringe::detail
