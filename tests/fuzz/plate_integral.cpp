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

/// Computes the greatest distance between a vertex of the triangle and a corner of the plate, which bounds
/// the distance of any two of their points.
double greatest_distance(const Triangle& triangle, const Rectangle& plate) {
  double greatest = 0;
  for (const Eigen::Vector3d& vertex : triangle)
    for (const int corner : {0, 1, 2, 3})
      greatest = std::max(
          greatest,
          (vertex - plate.corner - (corner % 2) * plate.edge_u - (corner / 2) * plate.edge_v).stableNorm());
  return greatest;
}

/// Thresholds relative to the greatest distance and to its square.
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
  // Random bytes seldom give a right angle, so mostly the second edge is replaced by a vector perpendicular
  // to the first.
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
    // Close to contact, rounding decides, and it does so in the same way whichever vertex comes first. But
    // the area of vertices that are collinear up to rounding does depend on the order.
    const bool apart = distance_between(triangle, plate) >= near_contact * greatest;
    if (apart || twice_area(triangle) >= thin * greatest * greatest)
      require(again == integral || std::abs(again - integral) <= rounding * integral,
              "it is the same whichever vertex comes first");
    if (apart)
      require(std::abs(in_a_batch - integral) <= rounding * integral, "it is the same alone and in a batch");
    require(std::isfinite(integral) || !apart, "it is finite without contact");
  } catch (const InputError&) {
    // The input is not finite, or the plate is not a rectangle.
  }
}

}  // namespace fringe::fuzz
