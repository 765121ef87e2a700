#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "fringe/gjk.hpp"
#include "fringe/plate_integral.hpp"
#include "geometry.hpp"

/// Tests properties that hold for any triangle. Tests triangles that, up to rounding, touch a rotated plate
/// or lie in its plane or in a border plane. Rounding decides whether they are in contact, and the decision
/// must not depend on which vertex comes first.
namespace fringe::FRINGE_TEST_FILE {
namespace {

using Eigen::Vector3d;
using test::Random;

const Rectangle plate{{0, 0, 0}, {1, 0, 0}, {0, 0.8, 0}};
constexpr int repetitions = 300;
constexpr double tolerance = 2e-14;

/// Returns a random triangle around the plate and at least a tenth of the plate's size above it, so that
/// rounding of the input matters less than the tolerance.
Triangle any_triangle(Random& random) {
  return random.triangle_in_box({-1, -1, 0.1}, {2, 1.8, 1});
}

void expect_same(double value, double expected) {
  EXPECT_NEAR(value, expected, tolerance * expected);
}

TEST(PlateIntegral, OfATriangleIsTheSumOverItsQuarters) {
  Random random(1);
  for (int i = 0; i < repetitions; ++i) {
    const auto [a, b, c] = any_triangle(random);
    const Vector3d ab = (a + b) / 2, bc = (b + c) / 2, ca = (c + a) / 2;
    const std::vector<Triangle> quarters{{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}};
    expect_same(test::total_integral(quarters, plate), plate_integral({a, b, c}, plate));
  }
}

TEST(PlateIntegral, DoesNotChangeWhenEverythingMoves) {
  Random random(2);
  for (int i = 0; i < repetitions; ++i) {
    const Triangle triangle = any_triangle(random);
    const Eigen::Isometry3d motion = random.rigid_motion();
    const Triangle moved{motion * triangle[0], motion * triangle[1], motion * triangle[2]};
    const Rectangle moved_plate{motion * plate.corner, motion.linear() * plate.edge_u,
                                motion.linear() * plate.edge_v};
    expect_same(plate_integral(moved, moved_plate), plate_integral(triangle, plate));
  }
}

TEST(PlateIntegral, DoesNotDependOnTheOrderOfTheVertices) {
  Random random(3);
  for (int i = 0; i < repetitions; ++i) {
    const auto [a, b, c] = any_triangle(random);
    const double expected = plate_integral({a, b, c}, plate);
    for (const Triangle& permuted :
         {Triangle{b, c, a}, Triangle{c, a, b}, Triangle{b, a, c}, Triangle{a, c, b}, Triangle{c, b, a}})
      expect_same(plate_integral(permuted, plate), expected);
  }
}

TEST(PlateIntegral, IsTheSameInFrontOfThePlateAndBehindIt) {
  Random random(4);
  for (int i = 0; i < repetitions; ++i) {
    const Triangle triangle = any_triangle(random);
    Triangle mirrored = triangle;
    for (Vector3d& vertex : mirrored)
      vertex.z() = -vertex.z();
    EXPECT_EQ(plate_integral(mirrored, plate), plate_integral(triangle, plate));
  }
}

TEST(PlateIntegral, DoesNotDependOnTheCornerThePlateIsDescribedFrom) {
  Random random(5);
  const auto& [corner, u, v] = plate;
  const std::array<Rectangle, 4> descriptions{Rectangle{corner, v, u}, Rectangle{corner + u, -u, v},
                                              Rectangle{corner + v, u, -v},
                                              Rectangle{corner + u + v, -v, -u}};
  for (int i = 0; i < repetitions; ++i) {
    const Triangle triangle = any_triangle(random);
    for (const Rectangle& description : descriptions)
      expect_same(plate_integral(triangle, description), plate_integral(triangle, plate));
  }
}

TEST(PlateIntegral, GrowsInProportionToTheUnitOfLength) {
  Random random(6);
  for (int i = 0; i < repetitions; ++i) {
    const Triangle triangle = any_triangle(random);
    const double expected = plate_integral(triangle, plate);
    for (const double factor : {1e-9, 0.37, 1e7}) {
      const Triangle scaled{factor * triangle[0], factor * triangle[1], factor * triangle[2]};
      const Rectangle scaled_plate{factor * plate.corner, factor * plate.edge_u, factor * plate.edge_v};
      expect_same(plate_integral(scaled, scaled_plate), factor * expected);
    }
  }
}

TEST(PlateIntegral, LiesBetweenAreaOverLargestAndAreaOverSmallestDistance) {
  // In front of the plate the distances are the heights.
  Random random(7);
  for (int i = 0; i < repetitions; ++i) {
    const Triangle triangle = random.triangle_in_box({0, 0, 0.01}, {1, 0.8, 1});
    const auto [lowest, highest] = std::minmax({triangle[0].z(), triangle[1].z(), triangle[2].z()});
    const double area = twice_area(triangle) / 2, value = plate_integral(triangle, plate);
    EXPECT_GE(value, area / highest);
    EXPECT_LE(value, area / lowest);
  }
}

TEST(PlateIntegral, OfManyTrianglesIsThatOfEach) {
  Random random(8);
  std::vector<Triangle> triangles;
  triangles.reserve(repetitions);
  for (int i = 0; i < repetitions; ++i)
    triangles.push_back(any_triangle(random));
  const std::vector<double> values = plate_integrals(triangles, plate);
  ASSERT_EQ(values.size(), triangles.size());
  for (std::size_t i = 0; i < triangles.size(); ++i)
    EXPECT_NEAR(values[i], plate_integral(triangles[i], plate), 4e-15 * values[i]);
  EXPECT_TRUE(plate_integrals({}, plate).empty());
}

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
