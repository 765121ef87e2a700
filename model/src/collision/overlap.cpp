#include <cmath>
#include <cstddef>
#include <limits>
#include <type_traits>

#include "collision/bounding_volume.hpp"
#include "collision/gjk_filter.hpp"
#include "fringe/bounding_volume.hpp"
#include "simd/dispatch.hpp"

namespace fringe {
namespace {

using Eigen::Vector3d;

constexpr double epsilon = std::numeric_limits<double>::epsilon();

/// Views a box as plain numbers without copying them.
const detail::BoxNumbers& numbers_of(const OrientedBox& box) {
  static_assert(std::is_standard_layout_v<OrientedBox> && sizeof(OrientedBox) == sizeof(detail::BoxNumbers) &&
                offsetof(OrientedBox, axes) == offsetof(detail::BoxNumbers, axes) &&
                offsetof(OrientedBox, half_widths) == offsetof(detail::BoxNumbers, half_widths));
  return reinterpret_cast<const detail::BoxNumbers&>(box);
}

/// Factor that allows for rounding in comparing a distance with a sum of radii: a length has at most two
/// roundings of its own and those of the differences it is computed from; a sum of radii has one.
constexpr double certain = 1 - 8 * epsilon;

/// Margin of box comparisons, relative to the sum of all lengths: ten times the rounding error of an oriented
/// box's axes.
constexpr double axes_margin = 1e-13;

/// Returns the norm without overflow or underflow of squares.
double length(const Vector3d& vector) {
  return std::hypot(vector.x(), vector.y(), vector.z());
}

/// Returns the same box, enlarged by rounding at most, as an oriented box.
OrientedBox oriented(const Eigen::AlignedBox3d& box) {
  const Vector3d rounding = 2 * epsilon * box.min().cwiseAbs().cwiseMax(box.max().cwiseAbs());
  return {box.min() / 2 + box.max() / 2, Eigen::Matrix3d::Identity(),
          box.max() / 2 - box.min() / 2 + rounding};
}

}  // namespace

bool overlap(const BoundingSphere& a, const BoundingSphere& b) {
  return !(length(b.centre - a.centre) * certain > a.radius + b.radius);
}

bool overlap(const BoundingSphere& sphere, const Eigen::AlignedBox3d& box) {
  const Vector3d beside = (box.min() - sphere.centre).cwiseMax(sphere.centre - box.max()).cwiseMax(0);
  return !(length(beside) * certain > sphere.radius);
}

bool overlap(const BoundingSphere& sphere, const OrientedBox& box) {
  const Vector3d offset = sphere.centre - box.centre;
  const Vector3d beside = ((box.axes * offset).cwiseAbs() - box.half_widths).cwiseMax(0);
  const double margin = axes_margin * (offset.lpNorm<1>() + box.half_widths.sum());
  return !(length(beside) * certain > sphere.radius + margin + std::numeric_limits<double>::min());
}

bool overlap(const Eigen::AlignedBox3d& a, const Eigen::AlignedBox3d& b) {
  return a.intersects(b);
}

bool overlap(const OrientedBox& a, const OrientedBox& b) {
  return detail::overlap_within(a, b, axes_margin);
}

bool overlap(const Eigen::AlignedBox3d& a, const OrientedBox& b) {
  return !a.isEmpty() && overlap(oriented(a), b);
}

bool detail::overlap_within(const OrientedBox& a, const OrientedBox& b, double relative_margin) {
  // Every compared quantity is a sum of products of an offset or a half-width with at most two axis
  // components, so its error is at most some ten times the error of the axes, times the sum of all lengths.
  // The comparison is written so that overflow counts as overlap.
  const double lengths = (b.centre - a.centre).lpNorm<1>() + a.half_widths.sum() + b.half_widths.sum();
  const double gap = detail::best_kernels<detail::GjkFilter>().box_gap(numbers_of(a), numbers_of(b));
  return !(gap > relative_margin * lengths + std::numeric_limits<double>::min());
}

}  // namespace fringe
