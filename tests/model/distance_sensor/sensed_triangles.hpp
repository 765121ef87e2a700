#pragma once

#include <functional>
#include <string>
#include <vector>

#include "fringe/distance_sensor.hpp"
#include "geometry.hpp"

/// Triangles and cones of every kind that has a trap of its own.
namespace fringe::test {

struct SensedTriangle {
  Triangle triangle;
  SensingCone cone;
};

struct SensedClass {
  std::string name;
  std::function<SensedTriangle(Random&)> make;
};

/// All of them with a range that reaches every triangle.
std::vector<SensedClass> sensed_classes();

}  // namespace fringe::test
