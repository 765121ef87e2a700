#include "bem/cross_approximation.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace fringe::detail {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Rows that are compared with the approximation before it counts as accurate. A row that no cross has
/// touched shows a part of the matrix that the crosses have missed.
constexpr int rows_to_check = 2;

class CrossApproximation {
 public:
  explicit CrossApproximation(const MatrixSource& source)
      : source_(source), factors_{MatrixXd(first_rank, source.rows), MatrixXd(first_rank, source.columns)},
        used_rows_(static_cast<std::size_t>(source.rows), false) {}

  LowRankFactors run(double tolerance) {
    const Index most = std::min(source_.rows, source_.columns);
    Index row = 0;
    int checked = 0;
    VectorXd rest(source_.columns), column(source_.rows);
    while (rank_ < most) {
      used_rows_[static_cast<std::size_t>(row)] = true;
      source_.row(row, rest.data());
      if (rank_ > 0)
        rest.noalias() -= factors_.columns.topRows(rank_).transpose() * factors_.rows.col(row).head(rank_);
      Index pivot = 0;
      const double largest = rest.cwiseAbs().maxCoeff(&pivot);
      const double elements = static_cast<double>(source_.rows) * static_cast<double>(source_.columns);
      const double small = tolerance * std::sqrt(squared_norm_ / elements);
      if (rank_ > 0 && largest <= small) {
        if (++checked > rows_to_check || !next_unused(row))
          break;
        continue;
      }
      checked = 0;
      source_.column(pivot, column.data());
      if (rank_ > 0)
        column.noalias() -=
            factors_.rows.topRows(rank_).transpose() * factors_.columns.col(pivot).head(rank_);
      append(column / rest[pivot], rest);
      if (!next_pivot(column, row))
        break;
    }
    factors_.rows.conservativeResize(rank_, Eigen::NoChange);
    factors_.columns.conservativeResize(rank_, Eigen::NoChange);
    return std::move(factors_);
  }

 private:
  static constexpr Index first_rank = 16;

  void append(const VectorXd& rows, const VectorXd& columns) {
    if (rank_ == factors_.rows.rows()) {
      factors_.rows.conservativeResize(2 * rank_, Eigen::NoChange);
      factors_.columns.conservativeResize(2 * rank_, Eigen::NoChange);
    }
    if (rank_ > 0)
      squared_norm_ +=
          2 * (factors_.rows.topRows(rank_) * rows).dot(factors_.columns.topRows(rank_) * columns);
    squared_norm_ += rows.squaredNorm() * columns.squaredNorm();
    factors_.rows.row(rank_) = rows.transpose();
    factors_.columns.row(rank_) = columns.transpose();
    ++rank_;
  }

  /// Finds the unused row with the largest element of the last cross's column.
  bool next_pivot(const VectorXd& column, Index& row) const {
    double largest = -1;
    for (Index k = 0; k < column.size(); ++k)
      if (!used_rows_[static_cast<std::size_t>(k)] && std::abs(column[k]) > largest) {
        largest = std::abs(column[k]);
        row = k;
      }
    return largest >= 0;
  }

  /// Finds the unused row at the greatest distance from used ones, by number.
  bool next_unused(Index& row) const {
    Index longest = 0, first = 0;
    for (Index k = 0; k <= source_.rows; ++k)
      if (k == source_.rows || used_rows_[static_cast<std::size_t>(k)]) {
        if (k - first > longest) {
          longest = k - first;
          row = first + (k - first) / 2;
        }
        first = k + 1;
      }
    return longest > 0;
  }

  const MatrixSource& source_;
  LowRankFactors factors_;
  std::vector<bool> used_rows_;
  Index rank_ = 0;
  double squared_norm_ = 0;  ///< of the approximation
};

}  // namespace

LowRankFactors cross_approximation(const MatrixSource& source, double tolerance) {
  return CrossApproximation(source).run(tolerance);
}

}  // namespace fringe::detail
