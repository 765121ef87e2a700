#include "geometry/polygon.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <utility>

#include <Eigen/Geometry>
#include <fmt/format.h>

#include "fringe/error.hpp"
#include "numeric/dyadic.hpp"

namespace fringe::detail {
namespace {

using Eigen::Vector2d;
using Outline = std::span<const Vector2d>;

/// Largest number of vertices: the time to check and divide a polygon grows with its square.
constexpr std::size_t most_vertices = 500;

/// Tests whether a point is on the segment from a to b.
bool is_on(const Vector2d& point, const Vector2d& a, const Vector2d& b) {
  return (a.cwiseMin(b).array() <= point.array()).all() && (point.array() <= a.cwiseMax(b).array()).all() &&
         orientation(a, b, point) == 0;
}

/// Tests whether the edges that begin at vertices i < j have a point in common, besides the vertex of
/// neighbours.
bool edges_meet(Outline vertices, std::size_t i, std::size_t j) {
  const std::size_t n = vertices.size();
  const Vector2d &a = vertices[i], &b = vertices[(i + 1) % n], &c = vertices[j], &d = vertices[(j + 1) % n];
  if (j == i + 1)
    return is_on(d, a, b) || is_on(a, c, d);
  if (i == 0 && j == n - 1)
    return is_on(c, a, b) || is_on(b, c, d);
  if (orientation(a, b, c) * orientation(a, b, d) < 0 && orientation(c, d, a) * orientation(c, d, b) < 0)
    return true;
  return is_on(c, a, b) || is_on(d, a, b) || is_on(a, c, d) || is_on(b, c, d);
}

std::optional<std::string> repetition_in(Outline vertices) {
  for (std::size_t k = 0; k < vertices.size(); ++k)
    for (std::size_t earlier = 0; earlier < k; ++earlier)
      if (vertices[k] == vertices[earlier])
        return fmt::format("vertex {} repeats vertex {}", k, earlier);
  return std::nullopt;
}

/// Returns the vertices of a simple polygon anticlockwise: in their order, or reversed.
std::vector<Vector2d> made_anticlockwise(Outline vertices) {
  // The turn at the least vertex, which is a corner of the convex hull, is that of the polygon.
  const auto is_less = [](const Vector2d& p, const Vector2d& q) {
    return p.x() < q.x() || (p.x() == q.x() && p.y() < q.y());
  };
  const std::size_t n = vertices.size();
  const auto k = static_cast<std::size_t>(std::ranges::min_element(vertices, is_less) - vertices.begin());
  std::vector<Vector2d> result(vertices.begin(), vertices.end());
  if (orientation(vertices[(k + n - 1) % n], vertices[k], vertices[(k + 1) % n]) < 0)
    std::ranges::reverse(result);
  return result;
}

/// Tests whether the outline of the vertices that are left turns left at the k-th of them, and the triangle
/// with its neighbours contains no other vertex, not even on its sides.
bool is_ear(Outline vertices, std::span<const std::size_t> left, std::size_t k) {
  const std::size_t n = left.size();
  const auto vertex = [&](std::size_t j) -> const Vector2d& { return vertices[left[j % n]]; };
  const Vector2d &a = vertex(k + n - 1), &b = vertex(k), &c = vertex(k + 1);
  if (orientation(a, b, c) <= 0)
    return false;
  const Eigen::AlignedBox2d box(a.cwiseMin(b).cwiseMin(c), a.cwiseMax(b).cwiseMax(c));
  for (std::size_t j = 0; j < n; ++j) {
    const Vector2d& p = vertex(j);
    if (!box.contains(p) || p == a || p == c)
      continue;
    if (p != b) {
      if (orientation(a, b, p) >= 0 && orientation(b, c, p) >= 0 && orientation(c, a, p) >= 0)
        return false;
    } else if (j != k) {
      // Another part of the outline touches this vertex, perhaps from within the triangle.
      for (const Vector2d& q : {vertex(j + n - 1), vertex(j + 1)})
        if (orientation(a, b, q) > 0 && orientation(b, c, q) > 0)
          return false;
    }
  }
  return true;
}

}  // namespace

int orientation(const Vector2d& a, const Vector2d& b, const Vector2d& c) {
  /// Bound of the rounding error, over the sum of the magnitudes of the two products (Shewchuk 1997).
  constexpr double rounding = 4 * 0x1p-53;
  constexpr double underflow = 1e-290;  ///< below this a product may have lost digits
  const double first = (b.x() - a.x()) * (c.y() - a.y()), second = (b.y() - a.y()) * (c.x() - a.x());
  const double doubled = first - second;
  if (std::abs(doubled) > rounding * (std::abs(first) + std::abs(second)) + underflow)
    return doubled > 0 ? 1 : -1;
  const Dyadic ax(a.x()), ay(a.y());
  return ((Dyadic(b.x()) - ax) * (Dyadic(c.y()) - ay) - (Dyadic(b.y()) - ay) * (Dyadic(c.x()) - ax)).sign();
}

ClippedOutline clip_ears(Outline vertices) {
  ClippedOutline clipped;
  std::vector<std::size_t> left(vertices.size());
  std::iota(left.begin(), left.end(), std::size_t{0});
  while (left.size() > 3) {
    const std::size_t n = left.size();
    std::size_t k = 0;
    while (k < n && !is_ear(vertices, left, k))
      ++k;
    if (k == n) {
      clipped.rest = std::move(left);
      return clipped;
    }
    clipped.ears.push_back({left[(k + n - 1) % n], left[k], left[(k + 1) % n]});
    left.erase(left.begin() + static_cast<std::ptrdiff_t>(k));
  }
  clipped.ears.push_back({left[2], left[0], left[1]});
  return clipped;
}

std::optional<std::string> defect_of_polygon(Outline vertices) {
  const std::size_t n = vertices.size();
  if (n < 3 || n > most_vertices)
    return fmt::format("must have 3 to {} vertices, not {}", most_vertices, n);
  if (std::optional<std::string> repetition = repetition_in(vertices))
    return repetition;
  if (std::ranges::all_of(vertices,
                          [&](const Vector2d& p) { return orientation(vertices[0], vertices[1], p) == 0; }))
    return "the vertices lie on a line, and enclose no area";
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = i + 1; j < n; ++j)
      if (edges_meet(vertices, i, j))
        return fmt::format(
            "edge {} (from vertex {}) meets edge {}: the outline must not cross or touch itself", i, i, j);
  return std::nullopt;
}

std::vector<Triangle> triangles_of_polygon(Outline vertices) {
  if (const std::optional<std::string> defect = defect_of_polygon(vertices))
    throw InputError(fmt::format("a polygon's vertices: {}", *defect));
  const std::vector<Vector2d> outline = made_anticlockwise(vertices);
  const auto lifted = [](const Vector2d& p) { return Eigen::Vector3d(p.x(), p.y(), 0); };
  std::vector<Triangle> triangles;
  for (const auto& [i, j, k] : clip_ears(outline).ears)
    triangles.push_back({lifted(outline[i]), lifted(outline[j]), lifted(outline[k])});
  return triangles;
}

namespace {

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
