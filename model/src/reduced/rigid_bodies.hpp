#pragma once

#include <vector>

#include <Eigen/Geometry>

#include "bem/bodies.hpp"
#include "reduced/shared_shapes.hpp"

namespace fringe::detail {

/// A body in the frame of its link, as the shape it shares with others of its kind.
struct RigidBody {
  PreparedShape* shape;
  double scale;
  Eigen::Isometry3d on_link;
};

/// Those of bodies_on_links(scene), one by one; energies of bodies of triangles are within `accuracy`. Throws
/// InputError for more triangles than are prepared, and for some that lie upon each other.
std::vector<RigidBody> rigid_bodies(const Scene& scene, const ChargedBodies& bodies, double accuracy,
                                    SharedShapes& shapes);

}  // namespace fringe::detail
