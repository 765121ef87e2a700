#include "fringe/plate_integral.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "fringe/batch_integral.hpp"
#include "fringe/error.hpp"
#include "fringe/gjk.hpp"
#include "input.hpp"

namespace fringe::fuzz {
namespace {

/// The greatest distance of a vertex from a corner is above that of any two points.
double greatest_distance(const Triangle& triangle, const Rectangle& plate) {
  double greatest = 0;
  for (const Eigen::Vector3d& vertex : triangle)
    for (const int corner : {0, 1, 2, 3})
      greatest = std::max(
          greatest,
          (vertex - plate.corner - (corner % 2) * plate.edge_u - (corner / 2) * plate.edge_v).stableNorm());
  return greatest;
}

/// Relative to the size of the set-up and its square.
constexpr double near_contact = 1e-6, thin = 1e-6;

double distance_between(const Triangle& triangle, const Rectangle& plate) {
  const std::array<Eigen::Vector3d, 4> corners{plate.corner, plate.corner + plate.edge_u,
                                               plate.corner + plate.edge_v,
                                               plate.corner + plate.edge_u + plate.edge_v};
  return gjk_distance(triangle, corners).distance;
}

}  // namespace

void plate_integral(Bytes bytes) {
  Input input(bytes);
  const Triangle triangle{input.point(), input.point(), input.point()};
  Rectangle plate{input.point(), input.point(), input.point()};
  // Bytes seldom make a right angle: mostly the second edge is turned into one, at right angles to the first.
  if (input.byte() % 4 != 0)
    plate.edge_v = plate.edge_u.cross(plate.edge_v);
  try {
    const double integral = fringe::plate_integral(triangle, plate);
    const double in_a_batch = plate_integrals(TriangleBatch({&triangle, 1}), plate).front();
    if (!in_a_scene({triangle[0], triangle[1], triangle[2], plate.corner, plate.edge_u, plate.edge_v}))
      return;
    if (!(integral >= 0 && in_a_batch >= 0))
      for (const Eigen::Vector3d& point :
           {triangle[0], triangle[1], triangle[2], plate.corner, plate.edge_u, plate.edge_v})
        fmt::print(stderr, "({:a}, {:a}, {:a})\n", point.x(), point.y(), point.z());
    require(integral >= 0, "the integral is a number, and not below zero");
    require(in_a_batch >= 0, "in a batch, too, it is a number, and not below zero");
    const Triangle turned{triangle[1], triangle[2], triangle[0]};
    const double again = fringe::plate_integral(turned, plate);
    const bool comparable =
        ordinary({triangle[0], triangle[1], triangle[2], plate.corner, plate.edge_u, plate.edge_v});
    if (!comparable)
      return;
    constexpr double rounding = 1e-9;
    const double greatest = greatest_distance(triangle, plate);
    require(!(integral < twice_area(triangle) / 2 / greatest * (1 - rounding)),
            "it is at least area over the greatest distance");
    // Next to contact rounding decides, the same whichever vertex comes first; but whether points on a line
    // but for rounding have an area, and which, it decides anew.
    const bool apart = distance_between(triangle, plate) >= near_contact * greatest;
    if (apart || twice_area(triangle) >= thin * greatest * greatest)
      require(again == integral || std::abs(again - integral) <= rounding * integral,
              "it is the same whichever vertex comes first");
    if (apart)
      require(std::abs(in_a_batch - integral) <= rounding * integral, "it is the same alone and in a batch");
    require(std::isfinite(integral) || !apart, "it is finite without contact");
  } catch (const InputError&) {
    // What is not finite, or no rectangle.
  }
}

}  // namespace fringe::fuzz
