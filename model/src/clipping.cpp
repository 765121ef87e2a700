#include "clipping.hpp"

#include <algorithm>
#include <cmath>

#include "compensated.hpp"

namespace fringe::detail {
namespace {

enum class Side { lower, upper };

/// The point where the edge ab meets coordinate = bound, `from_a` and `from_b` being the ends' signed
/// distances to it. It is reached from the nearer end, which keeps components that do not change exact and
/// the relative accuracy of those that do not change sign, and gives the same point for ab and ba.
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

/// Sutherland and Hodgman: the part of a convex piece on one side of coordinate = bound.
Piece clip(const Piece& piece, int axis, double bound, Side side) {
  Piece kept;
  const auto inside_by = [&](const PieceVertex& vertex) {
    const double above = vertex.position[axis] - bound;
    return side == Side::upper ? above : -above;
  };
  for (std::size_t i = 0; i < piece.size; ++i) {
    const PieceVertex& current = piece.vertices[i];
    const PieceVertex& next = piece.vertices[(i + 1) % piece.size];
    const double current_inside = inside_by(current), next_inside = inside_by(next);
    if (current_inside >= 0)
      kept.vertices[kept.size++] = current;
    if ((current_inside > 0 && next_inside < 0) || (current_inside < 0 && next_inside > 0))
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
  Extent result{piece.vertices[0].position[axis], piece.vertices[0].position[axis]};
  for (std::size_t i = 1; i < piece.size; ++i) {
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

}  // namespace fringe::detail
