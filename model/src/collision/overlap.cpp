#include <array>
#include <cmath>
#include <limits>

#include "box_overlap.hpp"
#include "fringe/bounding_volume.hpp"

namespace fringe {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double epsilon = std::numeric_limits<double>::epsilon();

}  // namespace

bool overlap(const BoundingSphere& a, const BoundingSphere& b) {
  // The distance has at most two roundings of its own and those of the differences; the sum has one.
  constexpr double certain = 1 - 8 * epsilon;
  const Vector3d offset = b.centre - a.centre;
  return !(std::hypot(offset.x(), offset.y(), offset.z()) * certain > a.radius + b.radius);
}

bool overlap(const Eigen::AlignedBox3d& a, const Eigen::AlignedBox3d& b) {
  return (a.min().array() <= b.max().array()).all() && (b.min().array() <= a.max().array()).all();
}

bool overlap(const OrientedBox& a, const OrientedBox& b) {
  // Ten times what the axes may be off.
  constexpr double margin = 1e-13;
  return detail::overlap_within(a, b, margin);
}

bool detail::overlap_within(const OrientedBox& a, const OrientedBox& b, double relative_margin) {
  // Everything compared below is a sum of products of an offset or a half-width with at most two components
  // of axes: what is off is at most some ten times what they are, times all lengths together. The comparisons
  // are written so that overflow means overlap.
  const Vector3d between = b.centre - a.centre;
  const double margin = relative_margin * (between.lpNorm<1>() + a.half_widths.sum() + b.half_widths.sum()) +
                        std::numeric_limits<double>::min();
  const Vector3d offset = a.axes * between;
  const Matrix3d turn = a.axes * b.axes.transpose(), cosines = turn.cwiseAbs();
  const Vector3d reach = a.half_widths + cosines * b.half_widths;
  for (Eigen::Index i = 0; i < 3; ++i)
    if (std::abs(offset[i]) > reach[i] + margin)
      return false;
  for (Eigen::Index j = 0; j < 3; ++j)
    if (std::abs(offset.dot(turn.col(j))) > b.half_widths[j] + cosines.col(j).dot(a.half_widths) + margin)
      return false;
  for (Eigen::Index i = 0; i < 3; ++i) {
    const Eigen::Index i1 = (i + 1) % 3, i2 = (i + 2) % 3;
    for (Eigen::Index j = 0; j < 3; ++j) {
      const Eigen::Index j1 = (j + 1) % 3, j2 = (j + 2) % 3;
      const double reach_a = a.half_widths[i1] * cosines(i2, j) + a.half_widths[i2] * cosines(i1, j);
      const double reach_b = b.half_widths[j1] * cosines(i, j2) + b.half_widths[j2] * cosines(i, j1);
      if (std::abs(offset[i2] * turn(i1, j) - offset[i1] * turn(i2, j)) > reach_a + reach_b + margin)
        return false;
    }
  }
  return true;
}

}  // namespace fringe
