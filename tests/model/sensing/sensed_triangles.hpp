#pragma once

#include <functional>
#include <ostream>
#include <string>
#include <vector>

#include "fringe/distance_sensor.hpp"
#include "geometry.hpp"
#include "real.hpp"

/// Triangles and cones in classes that are difficult in different ways, and what the cones see of them.
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

enum class Visibility {
  visible,    ///< interior points of the triangle lie inside the cone
  hidden,     ///< no point of the triangle is in the cone
  undecided,  ///< the two touch to 25 digits
};

struct ProgrammeAnswer {
  Visibility visibility;
  Real distance = 0;  ///< accurate to 13 digits more than a double
  RealVector offset =
      RealVector::Zero();  ///< from the apex to the nearest visible point, to 1e-15 of the distance
};

/// Computes the nearest point of a triangle in a cone of unlimited range, as a convex programme, which is
/// solved by an interior-point method in 100 digits without any distinction of cases. The cone's half angle
/// is first enlarged by `enlargement`, and must stay below 90°.
ProgrammeAnswer solve(const Triangle& triangle, const SensingCone& cone, double enlargement);

}  // namespace fringe::test
