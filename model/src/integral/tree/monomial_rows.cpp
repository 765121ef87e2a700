#include "integral/tree/monomial_rows.hpp"

#include "integral/tree/kernels.hpp"

#include "simd/dispatch.hpp"

namespace fringe::detail {

MonomialRows::MonomialRows(std::span<const WeightedPoint> points, const Eigen::Vector3d& centre,
                           const Eigen::Matrix3d& to_frame, int degree, Factor factor)
    : row_count_(monomial_count(degree)),
      stride_((points.size() + array_padding - 1) / array_padding * array_padding),
      rows_(new double[(row_count_ + 3) * stride_]) {
  double* const coordinates = rows_.get() + row_count_ * stride_;
  for (std::size_t j = 0; j < points.size(); ++j) {
    const Eigen::Vector3d point = to_frame * (points[j].position - centre);
    for (std::size_t axis = 0; axis < 3; ++axis)
      coordinates[axis * stride_ + j] = point[static_cast<Eigen::Index>(axis)];
    rows_[j] = factor == Factor::one ? 1 : points[j].weight;
  }
  for (std::size_t j = points.size(); j < stride_; ++j)
    for (double* const row : {rows_.get(), coordinates, coordinates + stride_, coordinates + 2 * stride_})
      row[j] = 0;
  const auto& kernels = best_kernels<TreeKernels>();
  for (std::size_t i = 1; i < row_count_; ++i)
    kernels.multiply(row(monomials[i].factor),
                     coordinates + static_cast<std::size_t>(monomials[i].axis) * stride_, stride_,
                     rows_.get() + i * stride_);
}

void MonomialRows::add_up(MonomialValues& sums) const {
  const auto& kernels = best_kernels<TreeKernels>();
  for (std::size_t i = 0; i < row_count_; ++i)
    sums[i] += kernels.sum(row(i), stride_);
}

}  // namespace fringe::detail
