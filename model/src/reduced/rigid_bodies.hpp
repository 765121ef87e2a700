#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include <Eigen/Geometry>

#include "bem/bodies.hpp"
#include "reduced/prepared_shape.hpp"

namespace fringe::detail {

/// Shapes by their proportions: bodies of the same proportions share one, which is prepared once.
class SharedShapes {
 public:
  /// Returns the shape of a plate or a box at the origin whose largest half side is 1.
  PreparedShape* find(const FacedSurface& surface);

  /// Returns the shape of a body of triangles, which are as in PreparedMesh.
  PreparedShape* find(const std::vector<Triangle>& triangles, double accuracy);

 private:
  std::vector<std::unique_ptr<PreparedShape>> shapes_;
};

/// A body in the frame of its link, with the shape that it shares with others of the same proportions.
struct RigidBody {
  PreparedShape* shape;
  double scale;
  Eigen::Isometry3d on_link;
};

/// Returns the bodies of bodies_on_links(scene), one by one; energies of bodies of triangles are within
/// `accuracy`. Throws InputError for more triangles than can be prepared, and for triangles that lie upon
/// each other.
std::vector<RigidBody> rigid_bodies(const Scene& scene, const ChargedBodies& bodies, double accuracy,
                                    SharedShapes& shapes);

}  // namespace fringe::detail
