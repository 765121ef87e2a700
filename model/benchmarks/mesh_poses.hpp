#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "fringe/scene.hpp"

/// Bodies of about a thousand triangles in random poses above a sensor.
namespace fringe::benchmarks {

struct MeshBody {
  std::string name;
  Shape shape;
  Shape known;      ///< the shape from which the true values are computed: the same body
  double known_to;  ///< the rtol of the true values
};

/// Returns a ball, a box and an L, 6 cm long.
std::vector<MeshBody> mesh_bodies();

/// Makes a scene of a sensor of 10 cm and a body on the link "body".
Scene mesh_scene(const Shape& shape);

/// Returns random poses in which a body is 3 mm, a twentieth of its size, to 10 cm from the sensor.
std::vector<Eigen::Isometry3d> mesh_poses(const Shape& shape, int count, std::uint64_t seed);

}  // namespace fringe::benchmarks
