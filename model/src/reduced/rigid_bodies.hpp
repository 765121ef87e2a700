#pragma once

#include <vector>

#include <Eigen/Geometry>

#include "bem/bodies.hpp"
#include "reduced/shared_shapes.hpp"

namespace fringe::detail {

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
