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

/// A shape as pieces whose union it is (or its surface, of a mesh), in the shape's frame.
struct ConvexPieces {
  std::vector<ConvexPiece> pieces;
  BoxTree tree;  ///< over the pieces

  /// Whether the pieces are triangles that bound a volume, which then belongs to the shape.
  bool bounds_volume = false;
};

/// Around a shape, in its frame.
OrientedBox enclosing_box(const Shape& shape);

/// A ball around enclosing_box of a mesh, which is looked for long where there are millions of triangles.
BoundingSphere ball_around_box(const Mesh& mesh);

/// An arc becomes a piece for each of its segments, a mesh one for each triangle.
ConvexPieces convex_pieces(const Shape& shape);

}  // namespace fringe::detail
