#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Core>

#include "fringe/maxwell_matrix.hpp"
#include "readings/readings.hpp"
#include "surface/bodies.hpp"

namespace fringe::detail {

/// Finds which part of the estimated errors is stated: as much as they turned out to be needed, with caution.
class BelievedError {
 public:
  /// @param remembered number of refinements that count; before there are so many, all of the errors is
  /// stated
  explicit BelievedError(std::size_t remembered) : remembered_(remembered) {}

  /// Takes the answer of the next solution, with its estimated errors and how much of them refinement leaves,
  /// of entries and of readings. Returns the part to be stated.
  double next(const MaxwellMatrix& answer, const Eigen::MatrixXd& lasting, const ReadingEffects& of_readings,
              const ChargedBodies& bodies);

 private:
  std::size_t remembered_;
  std::vector<double> used_;    ///< parts of the errors that the refinements used
  std::vector<double> values_;  ///< of the solution before: what is asked for
  std::vector<double> errors_;  ///< that refinement makes smaller
};

}  // namespace fringe::detail
