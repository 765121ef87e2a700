#include "geometry/polygon.hpp"

#include <algorithm>
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

}  // namespace fringe::detail
