#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "box_table.hpp"
#include "face.hpp"
#include "fringe/scene.hpp"

namespace fringe::detail {

/// Faces whose interaction among each other is known in closed terms: a plate's only one, or those of a box.
struct ChargedBody {
  std::size_t conductor;
  std::vector<Face> faces;     ///< in the world
  Eigen::Vector3d half_sides;  ///< of a box
  std::string name;            ///< for messages
};

/// The conductors of a scene as faces.
struct ChargedBodies {
  std::vector<std::string> names;  ///< the sensors', the grounded objects', the floating ones'
  std::size_t sensors = 0;
  std::size_t floating = 0;
  std::vector<ChargedBody> bodies;
};

/// Throws InputError for an object that is neither plate nor cuboid, or dielectric, for rectangles that are
/// none, and for bodies that have a point in common.
ChargedBodies charged_bodies(const Scene& scene);

}  // namespace fringe::detail
