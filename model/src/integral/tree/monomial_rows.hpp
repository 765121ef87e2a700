#pragma once

#include <cstddef>
#include <memory>
#include <span>

#include <Eigen/Core>

#include "integral/tree/monomials.hpp"
#include "integral/tree/weighted_point.hpp"

namespace fringe::detail {

/// The values of monomials at many points: one row per monomial, one element per point.
class MonomialRows {
 public:
  enum class Factor { one, weight };

  /// Evaluates the monomials up to a degree in to_frame·(p − centre), multiplied by one or by the point's
  /// weight.
  MonomialRows(std::span<const WeightedPoint> points, const Eigen::Vector3d& centre,
               const Eigen::Matrix3d& to_frame, int degree, Factor factor);

  std::size_t row_count() const { return row_count_; }

  /// Returns a monomial's values at all points, padded with zeros.
  const double* row(std::size_t monomial) const { return rows_.get() + monomial * stride_; }

  /// Adds the sum of each row to `sums`.
  void add_up(MonomialValues& sums) const;

 private:
  std::size_t row_count_;
  std::size_t stride_;
  std::unique_ptr<double[]> rows_;  ///< an array, because a vector would initialise its elements
};

}  // namespace fringe::detail
