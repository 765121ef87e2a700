#include <algorithm>
#include <cmath>
#include <string>

#include <gtest/gtest.h>

#include "triangle_classes.hpp"
#include "truth.hpp"

/// Tests the quadrature on integrals with known values, and compares the conditioning, which comes from
/// derivatives, with the change that a unit in the last place really causes.
namespace fringe::stress::FRINGE_TEST_FILE {
namespace {

const Rectangle plate{{0, 0, 0}, {2, 0, 0}, {0, 1, 0}};

Truth truth(const Triangle& triangle) {
  return integrate(dissect(triangle, plate));
}

DoubleDouble integral(const Triangle& triangle, const Rectangle& plate) {
  const Truth found = integrate(dissect(triangle, plate));
  EXPECT_TRUE(found.converged);
  return found.value;
}

void expect_value(const Triangle& triangle, const Real& expected) {
  EXPECT_LE(static_cast<double>(abs(Real(to_real(integral(triangle, plate)) / expected - 1))), 1e-20);
}

TEST(Truth, OfAParallelTriangleIsAreaOverHeight) {
  expect_value({{{0.5, 0.25, 0.125}, {1.5, 0.25, 0.125}, {0.5, 0.75, 0.125}}}, 2);
}

TEST(Truth, OfATriangleThatStandsOnItsVertexIsTheOneOfAWedge) {
  // d = z from 0 to 1, and the width at height z is z/2.
  expect_value({{{1, 0.5, 0}, {0.75, 0.5, 1}, {1.25, 0.5, 1}}}, Real(1) / 2);
}

TEST(Truth, OfATriangleThatTouchesACornerIsThatOfItsOppositeEdge) {
  // In polar coordinates about the corner: ∫dφ/cos φ over half of the right angle.
  expect_value({{{0, 0, 0}, {-1, 0, 0}, {-1, -1, 0}}}, log(1 + sqrt(Real(2))));
}

TEST(Truth, OfATriangleInABorderPlaneIsCountedOnce) {
  // d = z over the two halves of a 1 × 1 square.
  const double z = 1;
  const Real lower = to_real(truth({{{0, 0, z}, {0, 1, z}, {0, 1, 2 * z}}}).value);
  const Real upper = to_real(truth({{{0, 0, z}, {0, 1, 2 * z}, {0, 0, 2 * z}}}).value);
  EXPECT_LE(static_cast<double>(abs(Real(lower + upper - log(Real(2))))), 1e-20);
}

TEST(Truth, IsInfiniteWhereTheTriangleMeetsThePlateAlongASegment) {
  for (const Triangle& triangle :
       {Triangle{{{1, 0.5, -1}, {1, 0.75, 1}, {0.5, 0.25, 1}}},
        Triangle{{{1, 0.5, 0}, {1, 0.75, 0}, {1, 0.5, 1}}}, Triangle{{{0, -1, 0}, {0, 3, 0}, {-1, 0, 1}}}})
    EXPECT_TRUE(std::isinf(truth(triangle).value.high));
}

TEST(Truth, IsFiniteWhereATriangleBesideThePlateTouchesItsEdgeInOnePoint) {
  for (const double x : {0.0, 2.0})
    EXPECT_TRUE(
        std::isfinite(truth({{{x, 0.5, -1}, {x, 0.5, 1}, {x == 0 ? -1.0 : 3.0, 0.5, 0}}}).value.high));
}

/// Computes the largest relative change when each of the 18 numbers is replaced by its neighbours.
double largest_change(Triangle triangle, Rectangle plate) {
  const DoubleDouble value = integral(triangle, plate);
  double largest = 0;
  for (Eigen::Vector3d* vector :
       {triangle.data(), &triangle[1], &triangle[2], &plate.corner, &plate.edge_u, &plate.edge_v})
    for (double& number : *vector)
      for (const double towards : {-HUGE_VAL, HUGE_VAL}) {
        const double original = number;
        number = std::nextafter(number, towards);
        largest = std::max(largest, std::abs((integral(triangle, plate) - value).high / value.high));
        number = original;
      }
  return largest;
}

class Conditioning : public testing::TestWithParam<std::string> {};

TEST_P(Conditioning, IsWhatAUnitInTheLastPlaceChanges) {
  for (const Group& group : make_triangles(GetParam(), 4, 3))
    for (const Triangle& triangle : group.triangles) {
      const double expected = largest_change(triangle, group.plate);
      const Dissection dissection = dissect(triangle, group.plate);
      const double estimate =
          conditioning(dissection, triangle, group.plate, integrate(dissection).value.high);
      EXPECT_LE(estimate, 1.01 * expected);
      EXPECT_GE(estimate, 0.97 * expected);
    }
}

INSTANTIATE_TEST_SUITE_P(Classes, Conditioning,
                         testing::Values("random", "region-1", "region-2", "region-3", "nine-cells", "sliver",
                                         "parallel", "near-plate", "near-edge", "near-corner",
                                         "passing-closely", "far", "one-kilometre-away", "one-micrometre",
                                         "huge", "plane-through-corner", "plane-through-edge"),
                         [](const auto& name) {
                           std::string text = name.param;
                           std::replace(text.begin(), text.end(), '-', '_');
                           return text;
                         });

}  // namespace
}  // namespace fringe::stress::FRINGE_TEST_FILE
