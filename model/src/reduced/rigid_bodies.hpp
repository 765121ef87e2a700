#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include <Eigen/Geometry>

#include "fringe/error.hpp"
#include "reduced/prepared_shape.hpp"
#include "surface/bodies.hpp"
#include "surface/insulators.hpp"

namespace fringe::detail {

/// The reduced method's matrix takes no body of so many panels; its readings before a machine may.
class TooManyPanels : public InputError {
 public:
  using InputError::InputError;
};

/// A body in the frame of its link, with the shape that it shares with others of the same proportions.
struct RigidBody {
  PreparedShape* shape;
  double scale;
  Eigen::Isometry3d on_link;       ///< in the frame of its first part's link
  std::vector<std::size_t> parts;  ///< the charged bodies that it consists of; several are in contact
  std::vector<std::size_t> insulators = {};  ///< the dielectric bodies that touch them; alone without parts
};

/// The charged bodies, in contact, and the dielectric ones that make up a rigid body.
struct BodyGroup {
  std::vector<std::size_t> parts;
  std::vector<std::size_t> insulators;
};

/// Shapes by their proportions: bodies of the same proportions share one, which is prepared once.
class SharedShapes {
 public:
  /// Returns the shape of a plate or a box at the origin whose largest half side is 1.
  PreparedShape* find(const FacedSurface& surface);

  /// Returns the shape of a body of triangles, which are as in PreparedMesh.
  PreparedShape* find(const std::vector<TriangleSurface>& surfaces, double accuracy);

  /// Returns the shape of a body with insulators, which are as in PreparedMesh.
  PreparedShape* find(const InsulatedBodies& bodies, double accuracy);

  /// Forgets the shapes of several surfaces that none of these bodies has.
  void forget_others(const std::vector<RigidBody>& bodies);

 private:
  std::vector<std::unique_ptr<PreparedShape>> shapes_;
};

/// Returns the objects in the order of bodies_on_links.
std::vector<Object> ordered_objects(const Scene& scene);

/// Returns one body for each group. The surfaces of a group of several are triangles in the frame of its
/// first body's link, and so are `insulators`. `objects` are the last ones of `bodies`; energies of bodies of
/// triangles are within `accuracy`. Throws InputError for more triangles than can be prepared.
std::vector<RigidBody> rigid_bodies(const std::vector<Object>& objects, const ChargedBodies& bodies,
                                    const std::vector<Insulator>& insulators,
                                    const std::vector<BodyGroup>& groups, double accuracy,
                                    SharedShapes& shapes);

}  // namespace fringe::detail
