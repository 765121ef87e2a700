#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "fringe/plate_integral.hpp"
#include "geometry.hpp"
#include "integral/kernel.hpp"

/// Tests triangles at which formulas may fail: without area, on the plate, in a plane between two regions,
/// thin, nearly parallel to the plate, or in its border planes, where rounding decides on which side a vertex
/// lies.
namespace fringe::FRINGE_TEST_FILE {
namespace {

using Eigen::Vector3d;
using test::parallelogram;
using test::total_integral;

const Rectangle plate{{0, 0, 0}, {3, 0, 0}, {0, 2, 0}};
constexpr double infinity = std::numeric_limits<double>::infinity();

void expect_close(double value, double expected, double tolerance = 4e-15) {
  EXPECT_NEAR(value, expected, tolerance * expected);
}

TEST(PlateIntegralWithoutArea, IsZeroWhereverTheTriangleIs) {
  EXPECT_EQ(plate_integral({Vector3d{1, 1, 1}, {1, 1, 1}, {1, 1, 1}}, plate), 0);
  EXPECT_EQ(plate_integral({Vector3d{1, 1, 1}, {2, 1, 1}, {4, 1, 1}}, plate), 0);
  EXPECT_EQ(plate_integral({Vector3d{1, 1, 0}, {1, 1, 0}, {2, 1, 0}}, plate), 0) << "on the plate";
  EXPECT_EQ(plate_integral({Vector3d{1, 1, -1}, {1, 1, 1}, {1, 1, 0}}, plate), 0) << "through the plate";
  EXPECT_EQ(plate_integral({Vector3d{1, 1, -1}, {1, 1, 1}, {1, 1, 0}}, plate, Split{3}), 0);
}

TEST(PlateIntegralFarAway, EndsWhereDifferencesOfCoordinatesOverflow) {
  EXPECT_EQ(detail::kernel({infinity, 0, 0}, {0, 1, 0}, {0, 0, 1}), 0);
  const Rectangle far{{-1.5e308, 0, 0}, {3, 0, 0}, {0, 2, 0}};
  const Triangle triangle{Vector3d{1.5e308, 0, 1}, {1.5e308, 1e300, 1}, {1.5e308, 0, 1e300}};
  EXPECT_FALSE(plate_integral(triangle, far) > 0);
}

TEST(PlateIntegralOnThePlate, DivergesWhenTheTriangleLiesOnThePlate) {
  EXPECT_EQ(plate_integral({Vector3d{1, 1, 0}, {2, 1, 0}, {1, 2, 0}}, plate), infinity);
  EXPECT_EQ(plate_integral({Vector3d{-1, 1, 0}, {1, 1, 0}, {-1, 2, 0}}, plate), infinity) << "in part";
}

TEST(PlateIntegralOnThePlate, DivergesWhenTheTriangleCrossesThePlate) {
  EXPECT_EQ(plate_integral({Vector3d{1, 1, -1}, {2, 1, 1}, {1, 2, 1}}, plate), infinity);
  EXPECT_EQ(plate_integral({Vector3d{-1, 1, -2}, {1, 1, 1}, {-1, 1.5, 1}}, plate), infinity) << "in part";
  EXPECT_EQ(plate_integral({Vector3d{0, 0.5, -1}, {0, 1.5, -1}, {0, 1, 1}}, plate), infinity)
      << "through the edge";
}

TEST(PlateIntegralOnThePlate, DivergesWhenAnEdgeOfTheTriangleLiesOnThePlate) {
  EXPECT_EQ(plate_integral({Vector3d{1, 1, 0}, {2, 1, 0}, {1, 1, 1}}, plate), infinity);
  EXPECT_EQ(plate_integral({Vector3d{0, 0.5, 0}, {0, 1.5, 0}, {-1, 1, 0}}, plate), infinity)
      << "edge on edge";
  EXPECT_EQ(plate_integral({Vector3d{0, -1, 0}, {0, 3, 0}, {-1, 1, 1}}, plate), infinity) << "edge over edge";
}

TEST(PlateIntegralOnThePlate, IsFiniteWhenOnlyAVertexTouchesThePlate) {
  const std::vector<Triangle> touching{
      {Vector3d{1, 1, 0}, {1, 2, 1}, {2, 1, 1}},        // in front of it
      {Vector3d{0, 1, 0}, {-1, 0.5, 0}, {-1, 1.5, 0}},  // beside an edge, in the plate's plane
      {Vector3d{0, 1, 0}, {-1, 1, -1}, {-1, 1, 1}},     // across an edge's line, beside the plate
      {Vector3d{0, 0, 0}, {-1, -2, 0.5}, {-2, -1, 1}},  // at a corner
      {Vector3d{0, 0, 0}, {1, -1, 0}, {-1, -1, 0.5}},   // at a corner, in two regions
  };
  for (const Triangle& triangle : touching) {
    // The integral over a tip of relative size s is proportional to s.
    const auto [tip, b, c] = triangle;
    const double whole = plate_integral(triangle, plate);
    ASSERT_TRUE(std::isfinite(whole));
    const double size = 1e-3;
    const Vector3d tip_b = tip + size * (b - tip), tip_c = tip + size * (c - tip);
    expect_close(plate_integral({tip, tip_b, tip_c}, plate), size * whole, 1e-12);
    expect_close(total_integral({{tip, tip_b, tip_c}, {tip_b, b, c}, {tip_b, c, tip_c}}, plate), whole,
                 1e-12);
  }
}

TEST(PlateIntegralOnThePlate, IsFiniteInThePlatesPlaneBesideIt) {
  // The rectangle extends from x = −2 to x = −1 in the plate's plane: w·∫dx/x
  expect_close(total_integral(parallelogram({-2, 0.5, 0}, {1, 0, 0}, {0, 1, 0}), plate), std::log(2.0));
}

TEST(PlateIntegralInABorderPlane, IsCountedExactlyOnce) {
  // For a vertical rectangle above each of the four edges, d = z and the integral is w·ln(z₂/z₁).
  const Vector3d up(0, 0, 1);
  const double expected = std::log(2.0);
  for (const auto& [corner, along] : std::vector<std::pair<Vector3d, Vector3d>>{{{0, 0.5, 1}, {0, 1, 0}},
                                                                                {{3, 0.5, 1}, {0, 1, 0}},
                                                                                {{0.5, 0, 1}, {1, 0, 0}},
                                                                                {{0.5, 2, 1}, {1, 0, 0}}})
    expect_close(total_integral(parallelogram(corner, along, up), plate), expected);
}

TEST(PlateIntegralInABorderPlane, IsCountedOnceBesideTheCornersToo) {
  // In the plane x = 0 or x = 3 beside the edge, the distance is that to the corner. For z from 1 to 2 and y
  // from −1 to 0 the integral is ∫∫dy dz/√(y² + z²).
  for (const double x : {0.0, 3.0}) {
    const double value = total_integral(parallelogram({x, -1, 1}, {0, 1, 0}, {0, 0, 1}), plate);
    // F(y, z) = y·asinh(z/y) + z·asinh(y/z) is the integral over (0, y) × (0, z)
    const auto primitive = [](double y, double z) { return y * std::asinh(z / y) + z * std::asinh(y / z); };
    expect_close(value, primitive(1, 2) - primitive(1, 1));
  }
}

TEST(PlateIntegralInABorderPlane, IsContinuousAcrossThePlane) {
  for (const double offset : {-1e-15, 1e-15}) {
    const double value = total_integral(parallelogram({offset, -0.5, 1}, {0, 3, 0}, {0, 0, 1}), plate);
    expect_close(value, total_integral(parallelogram({0, -0.5, 1}, {0, 3, 0}, {0, 0, 1}), plate), 1e-14);
  }
}

TEST(PlateIntegralInABorderPlane, KeepsItsDigitsNextToThePlatesEdge) {
  // Here d = z, so the integral is twice the area times the second divided difference of z·ln z over the
  // three heights, which is 56.330799391238285179 to 20 digits. Two edges have equal lengths up to rounding.
  const double small = 0x1p-53;
  for (const double x : {0.0, 3.0})
    expect_close(plate_integral({Vector3d{x, 0.5, 0.625}, {x, 1, small}, {x, 1.5, 1.125 * small}}, plate),
                 0.3125 * 56.330799391238285);
}

TEST(PlateIntegralOfASliver, IsTheIntegralAlongItWhateverItsWidth) {
  // For a triangle with apex A and a base of width w at B: ∫dA/d = w·∫₀¹ s ds/d(A + s(B − A)). The ratio of
  // the integral to w must not depend on w.
  const Vector3d apex(-2, -1, 0.5), base(-1, -2.5, 1.5), across(0.75, 0.5, 0);  // across ⟂ base − apex
  const auto ratio = [&](double width) {
    return plate_integral({apex, base, base + width * across}, plate) /
           (twice_area({apex, base, base + width * across}));
  };
  const double expected = ratio(0x1p-40);
  for (const double width : {0x1p-30, 0x1p-36, 0x1p-44, 0x1p-48})
    expect_close(ratio(width), expected, 2e-9);
  for (const double width : {0x1p-44, 0x1p-48})
    expect_close(ratio(width), expected, 2e-12);
}

TEST(PlateIntegralOfANearlyParallelTriangle, AgreesWithQuadratureAtAnyTilt) {
  for (const Vector3d& corner : {Vector3d(1, 0.5, 1), Vector3d(-2, 0.5, 1), Vector3d(-2, -2, 1)})
    for (double tilt = 1e-17; tilt < 0.2; tilt *= 10) {
      const Triangle triangle{corner, corner + Vector3d(0.7, 0, 0.7 * tilt),
                              corner + Vector3d(0, 0.6, -0.3 * tilt)};
      expect_close(plate_integral(triangle, plate), plate_integral(triangle, plate, Gauss{32}), 4e-15);
    }
}

TEST(PlateIntegralOfAPlaneThroughTheCorner, AgreesWithQuadrature) {
  // The three vectors from the corner are coplanar: the pyramid over the triangle is flat.
  const Vector3d u(-1, -0.5, 0.25), v(-0.25, -1, 0.5);
  const Triangle triangle{u, 2 * u + v, u + 3 * v};
  expect_close(plate_integral(triangle, plate), plate_integral(triangle, plate, Gauss{64}), 4e-15);
}

TEST(PlateIntegralOfAPlaneThroughTheEdge, AgreesWithQuadrature) {
  // Beside the edge the three vectors are collinear in the cross section.
  const Triangle triangle{Vector3d{-1, 0.5, 0.5}, {-2, 0.75, 1}, {-1.5, 1.5, 0.75}};
  expect_close(plate_integral(triangle, plate), plate_integral(triangle, plate, Gauss{32}), 4e-15);
}

TEST(PlateIntegralNextToThePlate, DoesNotOverflowWhereHeightsHaveNoRatio) {
  // In front of the plate, the integral divided by twice the area is 1/h for one vertex at height 0 and two
  // at h, and (ln(h/z) − 1)/h for two vertices at z, where h/z overflows.
  const double z = 1e-315, h = 29;
  const Triangle one{Vector3d{1, 1, z}, {2, 1, h}, {1, 1.5, h}},
      two{Vector3d{1, 1, z}, {2, 1, z}, {1, 1.5, h}};
  const double mean_of_two = (std::log(h) - std::log(z) - 1) / h;
  expect_close(plate_integral(one, plate), twice_area(one) / h);
  expect_close(plate_integral(two, plate), twice_area(two) * mean_of_two);
  const std::vector<double> together = plate_integrals(std::vector{one, two}, plate);
  expect_close(together[0], twice_area(one) / h);
  expect_close(together[1], twice_area(two) * mean_of_two);
}

TEST(Kernel, IsANumberWhereLengthsHaveNoPowerOfTwoThatScalesThem) {
  // K is homogeneous of degree −1 and overflows for the smallest lengths.
  const auto of_size = [](double length) {
    return detail::kernel({length, 0, 0}, {0, length, 0}, {0, 0, length});
  };
  const double least = std::numeric_limits<double>::denorm_min();
  EXPECT_EQ(of_size(least), infinity);
  EXPECT_NEAR(of_size(0x1p-1022) * 0x1p-1022, of_size(1), 1e-15);
}

TEST(PlateIntegral, IsANumberNextToEveryFeatureOfThePlate) {
  test::Random random(11);
  for (double distance = 1e-300; distance < 1; distance *= 1e10)
    for (const Vector3d& feature :
         {Vector3d(1, 1, 0), Vector3d(0, 1, 0), Vector3d(0, 0, 0), Vector3d(3, 2, 0)})
      for (int i = 0; i < 20; ++i) {
        const Vector3d near = feature + distance * random.in_box({-1, -1, 0}, {1, 1, 1});
        const Triangle triangle{near, random.in_box({-1, -1, 0}, {4, 3, 2}),
                                random.in_box({-1, -1, 0}, {4, 3, 2})};
        const double value = plate_integral(triangle, plate);
        EXPECT_GT(value, 0);
        EXPECT_FALSE(std::isnan(value));
      }
}

TEST(PlateIntegralInATurnedBorderPlane, CountsNoPartTwice) {
  // The triangles extend across both ends of the edge. In a rotated plate's coordinates, rounding places the
  // vertices, and the corners that the cuts at the ends create, on either side of the border plane in any
  // pattern.
  const Rectangle plate{{0, 0, 0}, {0.7, 0, 0}, {0, 0.4, 0}};
  test::Random random(1);
  for (int i = 0; i < 4000; ++i) {
    const Triangle triangle = random.triangle_in_box({-1, 0.4, 0.2}, {1.7, 0.4, 1.5});
    const Eigen::Isometry3d motion = random.rigid_motion();
    const Triangle moved{motion * triangle[0], motion * triangle[1], motion * triangle[2]};
    const Rectangle moved_plate{motion * plate.corner, motion.linear() * plate.edge_u,
                                motion.linear() * plate.edge_v};
    const double expected = plate_integral(triangle, plate);
    // The tolerance covers thin triangles, which are sensitive to the rounding of their vertices.
    EXPECT_NEAR(plate_integral(moved, moved_plate), expected, 1e-9 * expected);
  }
}

TEST(PlateIntegralOnThePlate, DivergesOnTheFarEdgeOfAnyLength) {
  // The triangle's edge coincides exactly with the plate's edge y = length. The squares of most lengths are
  // not representable.
  for (double length = 0.05; length < 2; length *= 1.01) {
    const Rectangle plate{{0, 0, 0}, {0, length, 0}, {1, 0, 0}};
    EXPECT_TRUE(std::isinf(
        plate_integral({Vector3d{0.25, length, 0}, {0.75, length, 0}, {0.5, 2 * length, 1}}, plate)));
  }
}

}  // namespace
}  // namespace fringe::FRINGE_TEST_FILE
