#include <array>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "fringe/plate_integral.hpp"
#include "geometry.hpp"

/// Tests properties that hold for any triangle.
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

}  // namespace
}  // namespace fringe::FRINGE_TEST_FILE
