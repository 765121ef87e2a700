#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "fringe/gjk.hpp"
#include "fringe/plate_integral.hpp"
#include "geometry.hpp"

/// Tests triangles that, up to rounding, touch a rotated plate or lie in its plane or in a border plane.
/// Rounding decides whether they are in contact, and the decision must not depend on which vertex comes
/// first.
namespace fringe::FRINGE_TEST_FILE {
namespace {

using Eigen::Vector3d;

/// Length in m above the rounding errors of coordinates, which are of the order of 1 m here.
constexpr double rounding = 0x1p-49;

/// A triangle next to a plate.
struct Touching {
  Rectangle plate;
  Triangle triangle;
};

enum class Contact { edge_on_edge, edge_beside_edge, in_plane, in_border_plane, across_edge };
constexpr std::array contacts{Contact::edge_on_edge, Contact::edge_beside_edge, Contact::in_plane,
                              Contact::in_border_plane, Contact::across_edge};

Touching touching(Contact contact, test::Random& random) {
  const Eigen::Isometry3d turn = random.rigid_motion();
  const double length_u = random.uniform(0.5, 2), length_v = random.uniform(0.5, 2);
  const Rectangle plate{turn.translation(), turn.linear() * Vector3d(length_u, 0, 0),
                        turn.linear() * Vector3d(0, length_v, 0)};
  // Converts a position in units of the plate's edges and of 1 m along its normal. The callers use braces,
  // which draw random numbers in order with every compiler.
  const auto at = [&](const Vector3d& place) -> Vector3d {
    return plate.corner + place.x() * plate.edge_u + place.y() * plate.edge_v +
           place.z() * turn.linear().col(2);
  };
  const auto multiple = [&] { return std::floor(random.uniform(-4, 9)) / 4; };
  const auto anywhere = [&] {
    return at({random.uniform(-1, 2), random.uniform(-1, 2), random.uniform(-1, 1)});
  };
  switch (contact) {
  case Contact::edge_on_edge:
    return {plate, {plate.corner, plate.corner + plate.edge_u, anywhere()}};
  case Contact::edge_beside_edge:
    return {plate, {at({multiple(), 0, 0}), at({multiple(), 0, 0}), anywhere()}};
  case Contact::in_plane:
    return {plate,
            {at({multiple(), 0, 0}), at({multiple(), multiple(), 0}), at({multiple(), multiple(), 0})}};
  case Contact::in_border_plane:
    return {
        plate,
        {at({1, multiple(), multiple()}), at({1, multiple(), multiple()}), at({1, multiple(), multiple()})}};
  case Contact::across_edge:
    return {plate,
            {at({multiple(), 0, -random.uniform(0, 1)}), at({multiple(), 0, random.uniform(0, 1)}),
             at({multiple(), 0, random.uniform(0, 1)})}};
  }
  return {};
}

std::vector<Triangle> in_all_orders(const Triangle& triangle) {
  std::vector<Triangle> orders;
  std::array<std::size_t, 3> order{0, 1, 2};
  do
    orders.push_back({triangle[order[0]], triangle[order[1]], triangle[order[2]]});
  while (std::next_permutation(order.begin(), order.end()));
  return orders;
}

/// Calls check(scene, integral) for triangles that touch a plate, and counts the infinite integrals.
template <class Check>
void for_touching_triangles(const Check& check) {
  test::Random random(5);
  for (const Contact contact : contacts) {
    int infinite = 0, finite = 0;
    for (int i = 0; i < test::draws(3000); ++i) {
      const Touching scene = touching(contact, random);
      if (twice_area(scene.triangle) < 1e-9)
        continue;
      const double integral = plate_integral(scene.triangle, scene.plate);
      check(scene, integral);
      ++(std::isinf(integral) ? infinite : finite);
    }
    EXPECT_GT(std::min(infinite, finite), test::draws(300)) << "rounding decides either way";
  }
}

TEST(PlateIntegralAtATurnedPlate, IsTheSameWhicheverVertexComesFirst) {
  for_touching_triangles([](const Touching& scene, double integral) {
    for (const Triangle& triangle : in_all_orders(scene.triangle)) {
      const double value = plate_integral(triangle, scene.plate);
      // The only difference may be the rounding of the area.
      if (value != integral) {
        ASSERT_NEAR(value, integral, 4e-15 * integral);
      }
    }
  });
}

TEST(PlateIntegralAtATurnedPlate, IsTheSameAloneAndInABatch) {
  for_touching_triangles([](const Touching& scene, double integral) {
    for (const double value : plate_integrals(in_all_orders(scene.triangle), scene.plate)) {
      if (value != integral) {
        ASSERT_NEAR(value, integral, 1e-13 * integral);
      }
    }
  });
}

TEST(PlateIntegralAtATurnedPlate, IsInfiniteOnlyWithinRoundingOfContact) {
  for_touching_triangles([](const Touching& scene, double integral) {
    if (std::isfinite(integral))
      return;
    const auto& [corner, u, v] = scene.plate;
    const std::array<Vector3d, 4> corners{corner, corner + u, corner + v, corner + u + v};
    ASSERT_LE(gjk_distance(scene.triangle, corners).distance, rounding);
  });
}

TEST(PlateIntegralAtATurnedPlate, IsAtLeastThatOfTheTriangleMovedAwayByMoreThanRounding) {
  for_touching_triangles([](const Touching& scene, double integral) {
    const auto& [corner, u, v] = scene.plate;
    double least = std::numeric_limits<double>::infinity();
    for (const Vector3d& along : {u.normalized(), v.normalized(), u.cross(v).normalized()})
      for (const double distance : {-16 * rounding, 16 * rounding}) {
        Triangle moved = scene.triangle;
        for (Vector3d& vertex : moved)
          vertex += distance * along;
        least = std::min(least, plate_integral(moved, scene.plate));
      }
    ASSERT_GE(integral, least * (1 - 1e-12));
  });
}

}  // namespace
}  // namespace fringe::FRINGE_TEST_FILE
