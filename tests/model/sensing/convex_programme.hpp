#pragma once

#include <optional>

#include <boost/multiprecision/cpp_bin_float.hpp>

#include "fringe/distance_sensor.hpp"

/// The distance sensor's problem as a convex programme, solved by an interior-point method in 100 digits
/// without any distinction of cases.
namespace fringe::test {

using Real =
    boost::multiprecision::number<boost::multiprecision::cpp_bin_float<100>, boost::multiprecision::et_off>;

enum class Visibility {
  visible,    ///< interior points of the triangle lie inside the cone
  hidden,     ///< no point of the triangle is in the cone
  undecided,  ///< the two touch to 25 digits
};

struct ProgrammeAnswer {
  Visibility visibility;
  Real distance;                 ///< accurate to 13 digits more than a double
  std::array<Real, 3> offset{};  ///< from the apex to the nearest visible point, to 1e-15 of the distance
};

/// Computes the nearest point of a triangle in a cone of unlimited range. The cone's half angle is first
/// enlarged by `enlargement`, and must stay below 90°.
ProgrammeAnswer solve(const Triangle& triangle, const SensingCone& cone, double enlargement);

}  // namespace fringe::test
