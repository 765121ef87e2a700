#include "geometry/face_division.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "geometry/polygon.hpp"

namespace fringe::detail {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using Corners = std::span<const Vector3d>;

/// Twice the areas of the triangles of a face's first corner as vectors: their sum, and that of their
/// absolute values by components.
struct FanAreas {
  Vector3d sum = Vector3d::Zero();
  Vector3d extent = Vector3d::Zero();
};

FanAreas fan_areas(Corners corners) {
  FanAreas areas;
  for (std::size_t k = 1; k + 1 < corners.size(); ++k) {
    const Vector3d a = corners[k] - corners[0], b = corners[k + 1] - corners[0];
    const Vector3d part(a.y() * b.z() - a.z() * b.y(), a.z() * b.x() - a.x() * b.z(),
                        a.x() * b.y() - a.y() * b.x());
    areas.sum += part;
    areas.extent += part.cwiseAbs();
  }
  return areas;
}

/// Returns a face as seen along the axis of the largest areas, from the side from which it is anticlockwise.
std::vector<Vector2d> seen_outline(Corners corners, const FanAreas& areas) {
  Eigen::Index axis = 0;
  for (const Eigen::Index other : {1, 2})
    if (areas.extent[other] > areas.extent[axis])
      axis = other;
  Eigen::Index first = (axis + 1) % 3, second = (axis + 2) % 3;
  if (areas.sum[axis] < 0)
    std::swap(first, second);
  std::vector<Vector2d> outline;
  outline.reserve(corners.size());
  for (const Vector3d& corner : corners)
    outline.emplace_back(corner[first], corner[second]);
  return outline;
}

/// Tests whether the triangles of the first corner, which then cover the face, all turn left.
bool is_fan(std::span<const Vector2d> outline) {
  for (std::size_t k = 1; k + 1 < outline.size(); ++k)
    if (orientation(outline[0], outline[k], outline[k + 1]) <= 0)
      return false;
  return true;
}

/// Returns the length of the longest side of a face's box.
double longest_side(Corners corners) {
  Vector3d low = corners[0], high = corners[0];
  for (const Vector3d& corner : corners) {
    low = low.cwiseMin(corner);
    high = high.cwiseMax(corner);
  }
  return (high - low).maxCoeff();
}

/// Returns how far the corners of a face are from being in a plane; NaN for a face without area.
double bend_of(Corners corners, const Vector3d& area) {
  const double length = std::sqrt(area.x() * area.x() + area.y() * area.y() + area.z() * area.z());
  double low = 0, high = 0;
  for (const Vector3d& corner : corners) {
    const Vector3d side = corner - corners[0];
    const double height = (area.x() * side.x() + area.y() * side.y() + area.z() * side.z()) / length;
    if (std::isnan(height))
      return height;
    low = std::min(low, height);
    high = std::max(high, height);
  }
  return high - low;
}

/// Tests whether a triangle turns right by more than rounding in a face of this size.
bool turns_right(std::span<const Vector2d> outline, const CornersOfEar& triangle, double size) {
  constexpr double largest_of_rounding = 1e-9;  ///< twice an area, over the square of the size
  const Vector2d &a = outline[triangle[0]], &b = outline[triangle[1]], &c = outline[triangle[2]];
  const double doubled = (b.x() - a.x()) * (c.y() - a.y()) - (b.y() - a.y()) * (c.x() - a.x());
  return -doubled > largest_of_rounding * size * size;
}

}  // namespace

void append_face(std::vector<Triangle>& triangles, Corners corners, FaceDefects& defects) {
  /// Largest bend, over the longest side, without a remark: coordinates of a few digits have it.
  constexpr double largest_bend = 1e-3;
  const auto append = [&](std::size_t i, std::size_t j, std::size_t k) {
    triangles.push_back({corners[i], corners[j], corners[k]});
  };
  const std::size_t n = corners.size();
  if (n == 3)
    return append(0, 1, 2);
  const FanAreas areas = fan_areas(corners);
  const double size = longest_side(corners);
  if (const double bend = bend_of(corners, areas.sum); bend > largest_bend * size) {
    ++defects.bent;
    defects.bend = std::max(defects.bend, bend);
  }
  const std::vector<Vector2d> outline = seen_outline(corners, areas);
  if (is_fan(outline)) {
    for (std::size_t k = 1; k + 1 < n; ++k)
      append(0, k, k + 1);
    return;
  }
  const ClippedOutline clipped = clip_ears(outline);
  for (const auto& [i, j, k] : clipped.ears)
    append(i, j, k);
  bool crosses = clipped.rest.empty() && turns_right(outline, clipped.ears.back(), size);
  for (std::size_t k = 1; k + 1 < clipped.rest.size(); ++k) {
    const CornersOfEar triangle{clipped.rest[0], clipped.rest[k], clipped.rest[k + 1]};
    append(triangle[0], triangle[1], triangle[2]);
    crosses = crosses || turns_right(outline, triangle, size);
  }
  defects.crossing += crosses ? 1 : 0;
}

std::vector<std::string> remarks_on_faces(const FaceDefects& defects, double scale) {
  constexpr const char* advice = "triangles would say which surface is meant";
  std::vector<std::string> found;
  if (defects.bent > 0)
    found.push_back(fmt::format("faces whose corners are not in one plane: {}, by up to {:.2g} m; {}",
                                defects.bent, scale * defects.bend, advice));
  if (defects.crossing > 0)
    found.push_back(fmt::format("faces whose outline crosses itself: {}; {}", defects.crossing, advice));
  return found;
}

}  // namespace fringe::detail
