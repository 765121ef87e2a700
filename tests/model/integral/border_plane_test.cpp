#include <cmath>

#include <gtest/gtest.h>

#include "fringe/plate_integral.hpp"
#include "geometry.hpp"

/// Triangles in the planes that stand on the plate's edges, where rounding decides to which side a vertex
/// belongs.
namespace fringe {
namespace {

using Eigen::Vector3d;

TEST(PlateIntegralInATurnedBorderPlane, CountsNoPartTwice) {
  // Across both ends of the edge: in a turned plate's coordinates the vertices, and the corners that the cuts
  // at the ends make, lie on either side of the border plane by rounding, in any pattern.
  const Rectangle plate{{0, 0, 0}, {0.7, 0, 0}, {0, 0.4, 0}};
  test::Random random(1);
  for (int i = 0; i < 4000; ++i) {
    const Triangle triangle = random.triangle_in_box({-1, 0.4, 0.2}, {1.7, 0.4, 1.5});
    const Eigen::Isometry3d motion = random.rigid_motion();
    const Triangle moved{motion * triangle[0], motion * triangle[1], motion * triangle[2]};
    const Rectangle moved_plate{motion * plate.corner, motion.linear() * plate.edge_u,
                                motion.linear() * plate.edge_v};
    const double expected = plate_integral(triangle, plate);
    // Thin triangles among them are sensitive to the rounding of their vertices.
    EXPECT_NEAR(plate_integral(moved, moved_plate), expected, 1e-9 * expected);
  }
}

TEST(PlateIntegralOnThePlate, DivergesOnTheFarEdgeOfAnyLength) {
  // The edge y = length of the plate, as exactly as its length is a number: most lengths have a square that
  // is none.
  for (double length = 0.05; length < 2; length *= 1.01) {
    const Rectangle plate{{0, 0, 0}, {0, length, 0}, {1, 0, 0}};
    EXPECT_TRUE(std::isinf(
        plate_integral({Vector3d{0.25, length, 0}, {0.75, length, 0}, {0.5, 2 * length, 1}}, plate)));
  }
}

}  // namespace
}  // namespace fringe
