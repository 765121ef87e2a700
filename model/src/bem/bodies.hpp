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

/// A conductor made of flat rectangular faces (one for a plate, six for a box), or of arbitrary triangles.
/// Faces of one body interact through self_table or box_matrix.
struct ChargedBody {
  std::size_t conductor;
  std::vector<ChargedFace> faces;  ///< in world coordinates, or in the link's frame
  Eigen::Vector3d half_sides;      ///< half the sides of a box; zero for other shapes
  std::string name;                ///< for messages
  std::optional<std::size_t> link;
  std::vector<Triangle> triangles = {};  ///< the surface of a body without faces
};

/// The conductors of a scene as faces and triangles.
struct ChargedBodies {
  std::vector<std::string> names;  ///< sensors, then grounded, then floating conductors
  std::size_t sensors = 0;
  std::size_t floating = 0;
  std::vector<ChargedBody> bodies;
};

/// Returns true if a sensor is made of triangles.
bool sensors_have_panels(const ChargedBodies& bodies);

/// Returns the bodies in the frames of their links. Throws InputError for a dielectric object, for an invalid
/// rectangle or size, and for triangles without area or given twice.
ChargedBodies bodies_on_links(const Scene& scene);

/// Returns the body moved by a pose. Throws InputError if the pose is not finite.
ChargedBody moved(const ChargedBody& body, const Eigen::Isometry3d& pose);

/// Throws InputError if two bodies in world coordinates have a point in common, or if one is inside the other
/// and that is closed.
void refuse_contact(const ChargedBody& a, const ChargedBody& b);

/// Returns the bodies in world coordinates. Throws InputError as bodies_on_links and refuse_contact do.
ChargedBodies charged_bodies(const Scene& scene);

}  // namespace fringe::detail
