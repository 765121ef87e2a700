#pragma once

#include <algorithm>
#include <optional>

#include "geometry/clipping.hpp"

namespace fringe::detail {

/// Sorts the vertices of a triangle lexicographically by their coordinates.
inline LocalTriangle sorted(LocalTriangle triangle) {
  std::sort(triangle.begin(), triangle.end(), [](const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
    return a.x() != b.x() ? a.x() < b.x() : a.y() != b.y() ? a.y() < b.y() : a.z() < b.z();
  });
  return triangle;
}

/// Cuts a triangle at a plate's border planes into triangles that each lie in one cell, and calls visit(cell,
/// a, b, c, share) for each: with its corners in the plate's coordinates and its area as a positive share of
/// the whole triangle's. The pieces do not depend on which vertex comes first, because next to the plate
/// rounding decides between a finite integral and an infinite one.
template <class Visit>
void for_each_piece(const PlateFrame& plate, const LocalTriangle& in_any_order, const Visit& visit) {
  const LocalTriangle triangle = sorted(in_any_order);
  const Piece uncut = whole(triangle);
  const Extent extent_u = extent(uncut, 0), extent_v = extent(uncut, 1);
  const std::optional<Strip> only_u = only_strip(extent_u, plate.length_u);
  const std::optional<Strip> only_v = only_strip(extent_v, plate.length_v);
  if (only_u && only_v) {
    visit(Cell{*only_u, *only_v}, triangle[0], triangle[1], triangle[2], 1.0);
    return;
  }
  const auto visit_fan = [&](Cell cell, const Piece& piece) {
    const PieceVertex& hub = piece.vertices[0];
    for (std::size_t i = 1; i + 1 < piece.size; ++i) {
      const PieceVertex &first = piece.vertices[i], &second = piece.vertices[i + 1];
      const double share = share_of_area(hub, first, second);
      if (share > 0)
        visit(cell, hub.position, first.position, second.position, share);
    }
  };
  for (const Strip u : strips) {
    if (!has_share(u, extent_u, plate.length_u))
      continue;
    const Piece in_u = clip_to_strip(uncut, 0, u, plate.length_u);
    const Extent extent_in_u = extent(in_u, 1);
    for (const Strip v : strips)
      if (has_share(v, extent_in_u, plate.length_v))
        visit_fan({u, v}, clip_to_strip(in_u, 1, v, plate.length_v));
  }
}

}  // namespace fringe::detail
