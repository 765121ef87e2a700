#pragma once

#include <functional>
#include <ostream>
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

/// Its name in messages, in the place of its bytes, some of which have no value.
inline void PrintTo(const SensedClass& sensed, std::ostream* out) {
  *out << sensed.name;
}

/// All of them with a range that reaches every triangle.
std::vector<SensedClass> sensed_classes();

}  // namespace fringe::test
