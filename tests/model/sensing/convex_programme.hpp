#pragma once

#include <optional>

#include <boost/multiprecision/cpp_bin_float.hpp>

#include "fringe/distance_sensor.hpp"

/// The distance sensor as the convex programme it is, solved by an interior-point method in 100 digits, which
/// knows nothing of cases.
namespace fringe::test {

using Real =
    boost::multiprecision::number<boost::multiprecision::cpp_bin_float<100>, boost::multiprecision::et_off>;

enum class Visibility {
  visible,    ///< inside the triangle there are points inside the cone
  hidden,     ///< no point of the triangle is in the cone
  undecided,  ///< the two touch to 25 digits
};

struct ProgrammeAnswer {
  Visibility visibility;
  Real distance;  ///< right to 13 digits more than a double has
  std::array<Real, 3>
      offset{};  ///< from the apex to the nearest visible point, right to the distance's 1e-15
};

/// The nearest point of a triangle in a cone of unlimited range. Half of the cone's angle is first enlarged,
/// and must stay below 90°.
ProgrammeAnswer solve(const Triangle& triangle, const SensingCone& cone, double enlargement);

}  // namespace fringe::test
