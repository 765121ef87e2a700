#include "clipping.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

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

/// The part of a convex piece on one side of coordinate = bound (Sutherland and Hodgman).
Piece clip(const Piece& piece, int axis, double bound, Side side) {
  std::array<double, most_corners> inside_by;
  double innermost = 0, outermost = 0;
  for (std::size_t i = 0; i < piece.size; ++i) {
    const double above = piece.vertices[i].position[axis] - bound;
    inside_by[i] = side == Side::upper ? above : -above;
    innermost = std::max(innermost, inside_by[i]);
    outermost = std::min(outermost, inside_by[i]);
  }
  if (outermost == 0)
    return piece;
  const auto crosses = [&](std::size_t i, std::size_t j) {
    return (inside_by[i] > 0 && inside_by[j] < 0) || (inside_by[i] < 0 && inside_by[j] > 0);
  };
  if (innermost > 0) {
    int meetings = 0;  // of the outline with the plane
    for (std::size_t i = 0; i < piece.size; ++i)
      meetings += inside_by[i] == 0 || crosses(i, (i + 1) % piece.size);
    // A plane that divides a convex outline meets it twice. If it does not, the piece lies in the plane but
    // for rounding; its two parts would overlap, so all of it goes to one side.
    if (meetings != 2)
      return innermost > -outermost || (innermost == -outermost && side == Side::upper) ? piece : Piece{};
  }
  Piece kept;
  for (std::size_t i = 0; i < piece.size; ++i) {
    const std::size_t next = (i + 1) % piece.size;
    if (inside_by[i] >= 0)
      kept.vertices[kept.size++] = piece.vertices[i];
    if (crosses(i, next))
      kept.vertices[kept.size++] =
          cut(piece.vertices[i], piece.vertices[next], inside_by[i], inside_by[next], axis, bound);
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
