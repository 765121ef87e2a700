// A distance sensor.
//
// A distance sensor sees the part of the scene that lies in a cone. cone_closest() finds the point that is
// nearest to the cone's apex among the points of the triangles in the cone. Nothing can hide that point: what
// stood before it would be nearer.
//
// Run it:  build/examples/distance_sensor
// Expect:  looking straight at the wall, the sensor sees the foot of the perpendicular. Turned away, it
// sees the point where the boundary of the cone meets the wall. Turned further, it sees nothing within
// its range.
//
// Output:
//   turned by  0 degrees: 1.0000 m, at x = 0.0000 m
//   turned by 40 degrees: 1.0642 m, at x = 0.3640 m
//   turned by 80 degrees: nothing seen

#include <array>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <optional>

#include "fringe/distance_sensor.hpp"

int main() {
  // A wall in the plane z = 1 m, as two triangles.
  const Eigen::Vector3d a(-5, -5, 1), b(5, -5, 1), c(5, 5, 1), d(-5, 5, 1);
  const std::array<fringe::Triangle, 2> wall{fringe::Triangle{{a, b, c}}, fringe::Triangle{{a, c, d}}};
  constexpr double degree = std::numbers::pi / 180;

  for (const double turned : {0.0, 40.0, 80.0}) {
    const fringe::SensingCone cone{.apex = {0, 0, 0},
                                   .direction = {std::sin(turned * degree), 0, std::cos(turned * degree)},
                                   .full_angle = 40 * degree,
                                   .range = 1.9};
    if (const std::optional<fringe::VisiblePoint> seen = fringe::cone_closest(wall, cone))
      std::printf("turned by %2.0f degrees: %.4f m, at x = %.4f m\n", turned, seen->distance,
                  seen->point.x());
    else
      std::printf("turned by %2.0f degrees: nothing seen\n", turned);
  }
}
