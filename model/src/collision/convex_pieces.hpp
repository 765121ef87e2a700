#pragma once

#include <vector>

#include <Eigen/Geometry>

#include "fringe/bounding_volume.hpp"
#include "fringe/convex_shape.hpp"
#include "fringe/shape.hpp"
#include "geometry/box_tree.hpp"

namespace fringe::detail {

/// A convex piece of a shape.
struct ConvexPiece {
  ConvexShape shape;
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();  ///< from the piece's frame to the shape's
};

/// A shape divided into convex pieces in the shape's frame. Their union is the shape or, for a mesh, its
/// surface.
struct ConvexPieces {
  std::vector<ConvexPiece> pieces;
  BoxTree tree;  ///< bounding volume hierarchy over the pieces

  /// Whether the pieces are triangles that enclose a volume, which then belongs to the shape.
  bool bounds_volume = false;
};

/// Computes a box around a shape, in its frame.
OrientedBox enclosing_box(const Shape& shape);

/// Returns a ball that contains enclosing_box of a mesh, without computing that box, which takes long for
/// millions of triangles.
BoundingSphere ball_around_box(const Mesh& mesh);

/// Divides a shape into convex pieces: an arc into one for each segment, a mesh into one for each triangle.
ConvexPieces convex_pieces(const Shape& shape);

}  // namespace fringe::detail
