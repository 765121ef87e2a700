#pragma once

#include <vector>

#include <Eigen/Geometry>

#include "box_tree.hpp"
#include "fringe/bounding_volume.hpp"
#include "fringe/convex_shape.hpp"
#include "fringe/shape.hpp"

namespace fringe::detail {

/// A convex piece of a shape.
struct ConvexPiece {
  ConvexShape shape;
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();  ///< from the piece's frame to the shape's
};

/// A shape as pieces whose union it is, with what encloses it; all in the shape's frame.
struct ConvexPieces {
  std::vector<ConvexPiece> pieces;
  BoxTree tree;     ///< over the pieces
  OrientedBox box;  ///< around all
};

/// An arc becomes a piece for each of its segments, a mesh one for each triangle.
ConvexPieces convex_pieces(const Shape& shape);

}  // namespace fringe::detail
