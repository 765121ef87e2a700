#include <cmath>

#include <gtest/gtest.h>

#include "fringe/plate_integral.hpp"
#include "geometry.hpp"

/// Tests triangles in the plate's border planes, where rounding decides on which side a vertex lies.
namespace fringe::FRINGE_TEST_FILE {
namespace {

using Eigen::Vector3d;

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
