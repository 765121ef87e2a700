#include "clipping.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

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

double inside_by(const PieceVertex& vertex, int axis, double bound, Side side) {
  const double above = vertex.position[axis] - bound;
  return side == Side::upper ? above : -above;
}

/// All of a piece or nothing of it, for the side that it reaches farther into; one that is flat goes to
/// either, because the caller has chosen.
Piece all_or_nothing(const Piece& piece, int axis, double bound, Side side) {
  double innermost = 0, outermost = 0;
  for (std::size_t i = 0; i < piece.size; ++i) {
    const double inside = inside_by(piece.vertices[i], axis, bound, side);
    innermost = std::max(innermost, inside);
    outermost = std::min(outermost, inside);
  }
  const bool belongs =
      outermost == 0 || innermost > -outermost || (innermost == -outermost && side == Side::upper);
  return belongs ? piece : Piece{};
}

/// The part of a convex piece on one side of coordinate = bound (Sutherland and Hodgman).
Piece clip(const Piece& piece, int axis, double bound, Side side) {
  Piece kept;
  if (piece.size == 0)
    return kept;
  int meetings = 0;  // of the outline with the plane
  double next_inside = inside_by(piece.vertices[0], axis, bound, side);
  for (std::size_t i = 0; i < piece.size; ++i) {
    const PieceVertex& current = piece.vertices[i];
    const PieceVertex& next = piece.vertices[i + 1 < piece.size ? i + 1 : 0];
    const double current_inside = std::exchange(next_inside, inside_by(next, axis, bound, side));
    const bool crosses = (current_inside > 0 && next_inside < 0) || (current_inside < 0 && next_inside > 0);
    // A plane that divides a convex outline meets it twice. If more often, the piece lies in the plane but
    // for rounding, and its two parts would overlap.
    if ((crosses || current_inside == 0) && ++meetings > 2) {
      // Assigned, not returned: with one variable to return, the piece is built in place.
      kept = all_or_nothing(piece, axis, bound, side);
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

}  // namespace fringe::detail
