#include <cmath>
#include <cstddef>
#include <limits>
#include <type_traits>

#include "box_overlap.hpp"
#include "fringe/bounding_volume.hpp"
#include "quick_search.hpp"

namespace fringe {
namespace {

using Eigen::Vector3d;

constexpr double epsilon = std::numeric_limits<double>::epsilon();

/// A box as the plain numbers it is made of, without copying them.
const detail::BoxNumbers& numbers_of(const OrientedBox& box) {
  static_assert(std::is_standard_layout_v<OrientedBox> && sizeof(OrientedBox) == sizeof(detail::BoxNumbers) &&
                offsetof(OrientedBox, axes) == offsetof(detail::BoxNumbers, axes) &&
                offsetof(OrientedBox, half_widths) == offsetof(detail::BoxNumbers, half_widths));
  return reinterpret_cast<const detail::BoxNumbers&>(box);
}

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
  // Everything compared is a sum of products of an offset or a half-width with at most two components of
  // axes: what is off is at most some ten times what they are, times all lengths together. The comparison is
  // written so that overflow means overlap.
  const double lengths = (b.centre - a.centre).lpNorm<1>() + a.half_widths.sum() + b.half_widths.sum();
  const double gap = detail::best_search().box_gap(numbers_of(a), numbers_of(b));
  return !(gap > relative_margin * lengths + std::numeric_limits<double>::min());
}

}  // namespace fringe
