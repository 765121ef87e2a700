#pragma once

#include <functional>

#include <Eigen/Core>

namespace fringe::detail {

/// A matrix given by its rows and columns.
struct MatrixSource {
  Eigen::Index rows;
  Eigen::Index columns;
  std::function<void(Eigen::Index, double*)> row;     ///< writes a row
  std::function<void(Eigen::Index, double*)> column;  ///< writes a column
};

/// The factors of rowsᵀ·columns.
struct LowRankFactors {
  Eigen::MatrixXd rows;
  Eigen::MatrixXd columns;
};

/// Approximates a matrix by one of low rank from few of its rows and columns (adaptive cross approximation
/// with partial pivoting; Bebendorf 2000). Ends when a further cross, and then rows that were not used for
/// one, differ from the approximation by less than `tolerance` relative to the root mean square of its
/// elements.
LowRankFactors cross_approximation(const MatrixSource& source, double tolerance);

}  // namespace fringe::detail
