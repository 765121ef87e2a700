#include "integral/tree/monomial_rows.hpp"

#include <array>

#include "simd/vector_clones.hpp"

namespace fringe::detail {
namespace {

/// Rows are as long as several of the longest vectors of doubles.
constexpr std::size_t padding = 8;

FRINGE_VECTOR_CLONES
void multiply(double* __restrict product, const double* factor, const double* coordinate, std::size_t size) {
  for (std::size_t j = 0; j < size; ++j)
    product[j] = factor[j] * coordinate[j];
}

FRINGE_VECTOR_CLONES
double sum(const double* row, std::size_t size) {
  std::array<double, padding> partial{};
  for (std::size_t j = 0; j < size; j += padding)
    for (std::size_t lane = 0; lane < padding; ++lane)
      partial[lane] += row[j + lane];
  double total = 0;
  for (const double part : partial)
    total += part;
  return total;
}

}  // namespace

MonomialRows::MonomialRows(std::span<const WeightedPoint> points, const Eigen::Vector3d& centre,
                           const Eigen::Matrix3d& to_frame, int degree, Factor factor)
    : row_count_(monomial_count(degree)), stride_((points.size() + padding - 1) / padding * padding),
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
  for (std::size_t i = 1; i < row_count_; ++i)
    multiply(rows_.get() + i * stride_, row(monomials[i].factor),
             coordinates + static_cast<std::size_t>(monomials[i].axis) * stride_, stride_);
}

void MonomialRows::add_up(MonomialValues& sums) const {
  for (std::size_t i = 0; i < row_count_; ++i)
    sums[i] += sum(row(i), stride_);
}

}  // namespace fringe::detail
