#pragma once

#include <vector>

#include "fringe/reading_answer.hpp"
#include "readings/readings.hpp"
#include "reduced/reduced_system.hpp"
#include "surface/bodies.hpp"

/// Readings by the reduced method, with the background on the basis of the whole scene
/// (model/BOUNDARY_ELEMENTS.md, section 11).
namespace fringe::detail {

/// Readings in metres.
struct ReducedReadings {
  std::vector<ReadingAnswer> answers;
  /// For each body the largest part that its functions have in the error of a change, relative to
  /// change_scale().
  Eigen::VectorXd body_discretisation;
  double error = 0;       ///< the largest error of a change, alike
  double truncation = 0;  ///< the largest part that the steps have in such an error, alike
  double quadrature = 0;  ///< the largest part that the quadratures have, alike
  ReadingEffects facets;  ///< what the facets of round shapes may add; not a part of the errors
  /// Coefficients of X and Z (rows, see ReducedChange) in the columns of ReadingCharges::all().
  Eigen::MatrixXd charges = {};
};

/// Returns the readings by a solution that has a `change`. Conductors are those of `bodies`;
/// `per_discretisation` is the error per energy of the highest functions.
ReducedReadings reduced_readings(const std::vector<ChargedReading>& readings, const ReducedSolution& solution,
                                 double per_discretisation, const ChargedBodies& bodies);

}  // namespace fringe::detail
