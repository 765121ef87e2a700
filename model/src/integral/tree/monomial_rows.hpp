#pragma once

#include <cstddef>
#include <memory>
#include <span>

#include <Eigen/Core>

#include "integral/tree/monomials.hpp"
#include "integral/tree/weighted_point.hpp"

namespace fringe::detail {

/// The monomials at many points: a row for each monomial, an element for each point.
class MonomialRows {
 public:
  enum class Factor { one, weight };

  /// The monomials up to a degree of to_frame·(p − centre), times one or times the point's weight.
  MonomialRows(std::span<const WeightedPoint> points, const Eigen::Vector3d& centre,
               const Eigen::Matrix3d& to_frame, int degree, Factor factor);

  std::size_t row_count() const { return row_count_; }

  /// A monomial at every point; what follows the last point is 0.
  const double* row(std::size_t monomial) const { return rows_.get() + monomial * stride_; }

  /// Adds the sum of every row.
  void add_up(MonomialValues& sums) const;

 private:
  std::size_t row_count_;
  std::size_t stride_;
  std::unique_ptr<double[]> rows_;  ///< not cleared, unlike a vector
};

}  // namespace fringe::detail
