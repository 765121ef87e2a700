#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "bem/box_self_interaction.hpp"
#include "bem/face.hpp"
#include "fringe/scene.hpp"

namespace fringe::detail {

/// Faces whose interaction among each other is known in closed terms, a plate's only one or those of a box;
/// or any triangles.
struct ChargedBody {
  std::size_t conductor;
  std::vector<ChargedFace> faces;  ///< in the world, or in the link's frame
  Eigen::Vector3d half_sides;      ///< of a box
  std::string name;                ///< for messages
  std::optional<std::size_t> link;
  std::vector<Triangle> triangles = {};  ///< where the faces are; of a body without faces
};

/// The conductors of a scene as faces and triangles.
struct ChargedBodies {
  std::vector<std::string> names;  ///< the sensors', the grounded objects', the floating ones'
  std::size_t sensors = 0;
  std::size_t floating = 0;
  std::vector<ChargedBody> bodies;
};

/// Whether a sensor is made of triangles.
bool sensors_have_panels(const ChargedBodies& bodies);

/// The bodies in the frames of their links. Throws InputError for a dielectric object, for rectangles that
/// are none, for triangles without area and those that are there twice.
ChargedBodies bodies_on_links(const Scene& scene);

/// A body somewhere else. Throws InputError for a pose that is not finite.
ChargedBody moved(const ChargedBody& body, const Eigen::Isometry3d& pose);

/// Throws InputError when two bodies in the world have a point in common, or one is inside a closed other.
void refuse_contact(const ChargedBody& a, const ChargedBody& b);

/// The bodies in the world. Throws InputError as bodies_on_links does, and for bodies that have a point in
/// common.
ChargedBodies charged_bodies(const Scene& scene);

}  // namespace fringe::detail
