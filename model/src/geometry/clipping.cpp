#include "geometry/clipping.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "numeric/compensated.hpp"

namespace fringe::detail {
namespace {

enum class Side { lower, upper };

/// Computes the point where the edge ab meets the plane coordinate = bound, given the signed distances
/// `from_a` and `from_b` of the ends from it. Interpolation starts at the nearer end. This keeps constant
/// components exact, preserves the relative accuracy of components that do not change sign, and gives the
/// same point for ab and ba.
PieceVertex cut(const PieceVertex& a, const PieceVertex& b, double from_a, double from_b, int axis,
                double bound) {
  const double t = from_a / (from_a - from_b);
  if (t > 0.5)
    return cut(b, a, from_b, from_a, axis, bound);
  PieceVertex vertex{a.position + t * (b.position - a.position),
                     a.barycentric + t * (b.barycentric - a.barycentric)};
  vertex.position[axis] = bound;
  return vertex;
}

double inside_by(const PieceVertex& vertex, int axis, double bound, Side side) {
  const double above = vertex.position[axis] - bound;
  return side == Side::upper ? above : -above;
}

/// Decides for each corner whether it is inside, so that the outline changes sides at most twice. Corners
/// closest to the plane take the side of the next corner that is decided by its own distance.
std::array<bool, most_corners> sides(std::array<double, most_corners> inside, std::size_t size) {
  const auto next_asked = [&](std::size_t i) {
    do
      i = i + 1 < size ? i + 1 : 0;
    while (inside[i] == 0);
    return i;
  };
  const auto changes = [&] {
    int count = 0;
    for (std::size_t i = 0; i < size; ++i)
      count += inside[i] != 0 && (inside[i] > 0) != (inside[next_asked(i)] > 0);
    return count;
  };
  while (changes() > 2) {
    std::size_t nearest = next_asked(0);
    for (std::size_t i = 0; i < size; ++i)
      if (inside[i] != 0 && std::abs(inside[i]) < std::abs(inside[nearest]))
        nearest = i;
    inside[nearest] = 0;
  }
  std::array<bool, most_corners> result{};
  for (std::size_t i = 0; i < size; ++i)
    result[i] = inside[inside[i] == 0 ? next_asked(i) : i] > 0;
  return result;
}

/// Clips a piece to one side of the plane, along a single chord that the parts on both sides share whatever
/// the rounding.
Piece clip_along_chord(const Piece& piece, int axis, double bound, Side side) {
  std::array<double, most_corners> inside{};
  bool flat = true;
  for (std::size_t i = 0; i < piece.size; ++i) {
    inside[i] = inside_by(piece.vertices[i], axis, bound, side);
    flat = flat && inside[i] == 0;
  }
  // A piece that lies in the plane counts as inside on either side, because the caller has chosen the side.
  if (flat)
    return piece;
  const std::array<bool, most_corners> is_inside = sides(inside, piece.size);
  Piece kept;
  for (std::size_t i = 0; i < piece.size; ++i) {
    const std::size_t next = i + 1 < piece.size ? i + 1 : 0;
    if (is_inside[i])
      kept.vertices[kept.size++] = piece.vertices[i];
    if (is_inside[i] == is_inside[next])
      continue;
    // A corner whose distance has the wrong sign lies on the plane up to rounding.
    const auto distance = [&](std::size_t corner) {
      return (inside[corner] > 0) == is_inside[corner] ? std::abs(inside[corner]) : 0.0;
    };
    const double from = distance(i), to = distance(next);
    kept.vertices[kept.size++] = from + to > 0
                                     ? cut(piece.vertices[i], piece.vertices[next], from, -to, axis, bound)
                                     : piece.vertices[next];
  }
  return kept;
}

/// Clips a convex piece to one side of the plane coordinate = bound (Sutherland and Hodgman).
Piece clip(const Piece& piece, int axis, double bound, Side side) {
  Piece kept;
  if (piece.size == 0)
    return kept;
  int meetings = 0;  // number of points where the outline meets the plane
  double next_inside = inside_by(piece.vertices[0], axis, bound, side);
  for (std::size_t i = 0; i < piece.size; ++i) {
    const PieceVertex& current = piece.vertices[i];
    const PieceVertex& next = piece.vertices[i + 1 < piece.size ? i + 1 : 0];
    const double current_inside = std::exchange(next_inside, inside_by(next, axis, bound, side));
    const bool crosses = (current_inside > 0 && next_inside < 0) || (current_inside < 0 && next_inside > 0);
    // A plane that divides a convex outline meets it twice. If it meets it more often, the piece or one of
    // its edges lies in the plane up to rounding, and its two parts might overlap.
    if ((crosses || current_inside == 0) && ++meetings > 2) {
      // Assigned instead of returned directly: with a single return variable the piece is constructed in
      // place.
      kept = clip_along_chord(piece, axis, bound, side);
      return kept;
    }
    if (current_inside >= 0)
      kept.vertices[kept.size++] = current;
    if (crosses)
      kept.vertices[kept.size++] = cut(current, next, current_inside, next_inside, axis, bound);
  }
  return kept;
}

}  // namespace

Piece whole(const LocalTriangle& triangle) {
  Piece piece;
  piece.size = 3;
  for (std::size_t i = 0; i < 3; ++i)
    piece.vertices[i] = {triangle[i], Eigen::Vector3d::Unit(static_cast<Eigen::Index>(i))};
  return piece;
}

Extent extent(const Piece& piece, int axis) {
  Extent result{std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
  for (std::size_t i = 0; i < piece.size; ++i) {
    result.lowest = std::min(result.lowest, piece.vertices[i].position[axis]);
    result.highest = std::max(result.highest, piece.vertices[i].position[axis]);
  }
  return result;
}

bool has_share(Strip strip, Extent extent, double length) {
  switch (strip) {
  case Strip::below:
    return extent.lowest < 0 || extent.highest <= 0;
  case Strip::within:
    return extent.highest > 0 && extent.lowest < length;
  case Strip::above:
    return extent.highest > length || extent.lowest >= length;
  }
  return false;
}

std::optional<Strip> only_strip(Extent extent, double length) {
  std::optional<Strip> only;
  for (const Strip strip : strips) {
    if (!has_share(strip, extent, length))
      continue;
    if (only)
      return std::nullopt;
    only = strip;
  }
  return only;
}

Piece clip_to_strip(const Piece& piece, int axis, Strip strip, double length) {
  switch (strip) {
  case Strip::below:
    return clip(piece, axis, 0, Side::lower);
  case Strip::within:
    return clip(clip(piece, axis, 0, Side::upper), axis, length, Side::lower);
  case Strip::above:
    return clip(piece, axis, length, Side::upper);
  }
  return {};
}

double share_of_area(const PieceVertex& a, const PieceVertex& b, const PieceVertex& c) {
  return std::abs(a.barycentric.dot(cross(b.barycentric, c.barycentric)));
}

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
