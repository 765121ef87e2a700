/// The nine cells of a plate's border planes: pieces make up the triangle, lie in their cells, and are as far
/// from the plate as the cells say.

#include "geometry/clipping.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "geometry.hpp"
#include "geometry/plate_frame.hpp"

namespace fringe::detail::FRINGE_TEST_FILE {
namespace {

using Eigen::Vector3d;

/// Returns the shares of the area of a convex piece.
double share(const Piece& piece) {
  double sum = 0;
  for (std::size_t k = 2; k < piece.size; ++k)
    sum += share_of_area(piece.vertices[0], piece.vertices[k - 1], piece.vertices[k]);
  return sum;
}

bool is_within(Strip strip, double coordinate, double length) {
  constexpr double rounding = 1e-12;
  return strip == Strip::below    ? coordinate < rounding
         : strip == Strip::within ? coordinate > -rounding && coordinate < length + rounding
                                  : coordinate > length - rounding;
}

TEST(Clipping, PiecesMakeUpTheTriangleAndLieInTheirCells) {
  test::Random random(1);
  const PlateFrame plate = plate_frame({{1, 2, 3}, {0, 0.7, 0}, {0, 0, -1.2}});
  for (int i = 0; i < 300; ++i) {
    const Triangle triangle = random.triangle_in_box({-1, 1, 0.5}, {2, 4, 4});
    const LocalTriangle local = to_local(plate, triangle);
    double sum = 0;
    for (const Strip u : strips)
      for (const Strip v : strips) {
        const Piece piece =
            clip_to_strip(clip_to_strip(whole(local), 0, u, plate.length_u), 1, v, plate.length_v);
        sum += share(piece);
        for (std::size_t k = 0; k < piece.size; ++k) {
          const auto& [position, barycentric] = piece.vertices[k];
          EXPECT_TRUE(is_within(u, position.x(), plate.length_u));
          EXPECT_TRUE(is_within(v, position.y(), plate.length_v));
          EXPECT_NEAR(from_plate(plate, {u, v}, position).norm(), distance(plate, position), 1e-12);
          const Vector3d again =
              barycentric[0] * local[0] + barycentric[1] * local[1] + barycentric[2] * local[2];
          EXPECT_LT((again - position).norm(), 1e-12);
        }
      }
    EXPECT_NEAR(sum, 1, 1e-12);
  }
}

TEST(Clipping, APlatesFrameKeepsDistancesAndPutsThePlateIntoItsCorner) {
  test::Random random(2);
  const Rectangle plate{{1, 2, 3}, {0.3, 0.4, 0}, {-0.8, 0.6, 0}};
  const PlateFrame frame = plate_frame(plate);
  EXPECT_NEAR(frame.length_u, 0.5, 1e-15);
  EXPECT_NEAR(frame.length_v, 1, 1e-15);
  const LocalTriangle corners =
      to_local(frame, {plate.corner, plate.corner + plate.edge_u, plate.corner + plate.edge_v});
  EXPECT_LT(corners[0].norm(), 1e-15);
  EXPECT_LT((corners[1] - Vector3d(0.5, 0, 0)).norm(), 1e-15);
  EXPECT_LT((corners[2] - Vector3d(0, 1, 0)).norm(), 1e-15);
  for (int i = 0; i < 100; ++i) {
    const Triangle triangle = random.triangle_in_box({-1, -1, -1}, {5, 5, 5});
    const LocalTriangle local = to_local(frame, triangle);
    EXPECT_NEAR((local[1] - local[0]).norm(), (triangle[1] - triangle[0]).norm(), 1e-13);
    // No point of the plate is nearer than the distance, and one of a fine grid is nearly as near.
    double nearest = 1e9;
    for (double u = 0; u <= 1; u += 1.0 / 64)
      for (double v = 0; v <= 1; v += 1.0 / 64)
        nearest =
            std::min(nearest, (plate.corner + u * plate.edge_u + v * plate.edge_v - triangle[0]).norm());
    EXPECT_LE(distance(frame, local[0]), nearest + 1e-13);
    EXPECT_GE(distance(frame, local[0]), nearest - 0.02);
  }
}

TEST(Clipping, WhatLiesInABorderPlaneBelongsToOneStrip) {
  const LocalTriangle upright{Vector3d(1, 0, 0), Vector3d(1, 1, 0), Vector3d(1, 0, 1)};
  int strips_with_share = 0;
  for (const Strip strip : strips)
    strips_with_share += has_share(strip, extent(whole(upright), 0), 1) ? 1 : 0;
  EXPECT_EQ(strips_with_share, 1);
  EXPECT_TRUE(only_strip(extent(whole(upright), 0), 1));
  EXPECT_FALSE(only_strip(extent(whole(upright), 1), 0.5));
}

}  // namespace
}  // namespace fringe::detail::FRINGE_TEST_FILE
