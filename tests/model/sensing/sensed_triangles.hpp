#pragma once

#include <functional>
#include <ostream>
#include <string>
#include <vector>

#include "fringe/distance_sensor.hpp"
#include "geometry.hpp"

/// Triangles and cones in classes that are difficult in different ways.
namespace fringe::test {

struct SensedTriangle {
  Triangle triangle;
  SensingCone cone;
};

struct SensedClass {
  std::string name;
  std::function<SensedTriangle(Random&)> make;
};

/// Prints the class by its name instead of its bytes, some of which are indeterminate.
inline void PrintTo(const SensedClass& sensed, std::ostream* out) {
  *out << sensed.name;
}

/// Returns all classes. Their cones have a range that reaches every triangle.
std::vector<SensedClass> sensed_classes();

}  // namespace fringe::test
