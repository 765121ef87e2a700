#pragma once

#include <string>
#include <vector>

#include "fringe/scene.hpp"
#include "fringe/triangle.hpp"

namespace fringe {

/// The surface of one sensor or object in the world frame.
struct Conductor {
  std::string name;
  std::vector<Triangle> triangles;
};

/// Returns the conductors of a scene, the sensors first, each in the file's order. A sensor's plate is two
/// triangles: (corner, corner+u, corner+u+v) and (corner, corner+u+v, corner+v).
std::vector<Conductor> conductors(const Scene& scene);

}  // namespace fringe
