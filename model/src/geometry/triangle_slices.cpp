#include "geometry/triangle_slices.hpp"

namespace fringe::detail {
namespace {

using Eigen::Vector3d;

struct SliceCorner {
  Vector3d point;
  double value;
};

/// A convex polygon of at most five corners.
struct SlicePolygon {
  std::array<SliceCorner, 5> corners;
  std::size_t size = 0;

  void add(const SliceCorner& corner) { corners[size++] = corner; }
};

/// Computes the point of the edge ab where the value equals the given level. Interpolation starts at the
/// nearer end: constant coordinates stay exact, and ab and ba give the same point.
SliceCorner at_level(const SliceCorner& a, const SliceCorner& b, double level) {
  const double from_a = level - a.value, from_b = level - b.value;
  const double share = from_a / (from_a - from_b);
  if (share > 0.5)
    return {b.point + from_b / (from_b - from_a) * (a.point - b.point), level};
  return {a.point + share * (b.point - a.point), level};
}

/// Clips a polygon to direction·(value − level) ≥ 0. Returns an empty polygon when only a point or a line
/// would remain.
SlicePolygon clip(const SlicePolygon& polygon, double level, double direction) {
  SlicePolygon kept;
  bool has_inside = false;
  for (std::size_t i = 0; i < polygon.size; ++i) {
    const SliceCorner &here = polygon.corners[i], &next = polygon.corners[(i + 1) % polygon.size];
    const double inside = direction * (here.value - level), next_inside = direction * (next.value - level);
    has_inside = has_inside || inside > 0;
    if (inside >= 0)
      kept.add(here);
    if ((inside > 0 && next_inside < 0) || (inside < 0 && next_inside > 0))
      kept.add(at_level(here, next, level));
  }
  return has_inside ? kept : SlicePolygon{};
}

/// Triangulates a polygon as a fan from its first corner.
Slice fan(const SlicePolygon& polygon) {
  Slice slice;
  for (std::size_t i = 1; i + 1 < polygon.size; ++i)
    slice.triangles[slice.size++] = {polygon.corners[0].point, polygon.corners[i].point,
                                     polygon.corners[i + 1].point};
  return slice;
}

}  // namespace

Slices slices(const Triangle& triangle, const Vector3d& values, double low, double high) {
  if (values.maxCoeff() <= low)
    return {{{triangle}, 1}, {}, {}};
  if (values.minCoeff() >= high)
    return {{}, {}, {{triangle}, 1}};
  SlicePolygon whole;
  for (std::size_t i = 0; i < 3; ++i)
    whole.add({triangle[i], values[static_cast<Eigen::Index>(i)]});
  return {fan(clip(whole, low, -1)), fan(clip(clip(whole, low, 1), high, -1)), fan(clip(whole, high, 1))};
}

std::array<Triangle, 2> halves(const Triangle& triangle) {
  std::size_t apex = 0;
  double longest = -1;
  for (std::size_t i = 0; i < 3; ++i) {
    const double opposite = (triangle[(i + 2) % 3] - triangle[(i + 1) % 3]).squaredNorm();
    if (opposite > longest) {
      longest = opposite;
      apex = i;
    }
  }
  const Vector3d &top = triangle[apex], &from = triangle[(apex + 1) % 3], &to = triangle[(apex + 2) % 3];
  const Vector3d middle = from + (to - from) / 2;
  return {Triangle{top, from, middle}, Triangle{top, middle, to}};
}

}  // namespace fringe::detail
