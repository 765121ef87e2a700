#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "fringe/error.hpp"
#include "fringe/rectangle.hpp"
#include "fringe/triangle.hpp"
#include "fringe/triangulation.hpp"
#include "geometry.hpp"
#include "geometry/clipping.hpp"
#include "geometry/plate_frame.hpp"

/// Triangles and rectangles; triangles cut by the levels of an affine function, and by the border planes of a
/// plate into the nine cells: the parts make up the triangle, lie where their names say, and are as far from
/// the plate as the cells say.
namespace fringe::detail::FRINGE_TEST_FILE {
namespace {

using Eigen::Vector3d;

TEST(Triangle, TwiceAreaOfARightTriangleIsTheProductOfItsLegs) {
  EXPECT_DOUBLE_EQ(twice_area({Eigen::Vector3d{1, 1, 1}, {4, 1, 1}, {1, 1, 5}}), 12);
}

TEST(Triangle, TwiceAreaOfASliverKeepsItsDigits) {
  // The base is 2⁻⁴⁰ along x, far from the origin compared with its length, and the height 1.25 along (0, 3,
  // 4)/5. All coordinates are representable.
  const double base = 0x1p-40;
  const Triangle sliver{Eigen::Vector3d{1, 0, 0}, {1 + base, 0, 0}, {1, 0.75, 1}};
  EXPECT_DOUBLE_EQ(twice_area(sliver), base * 1.25);
}

TEST(Triangle, TwiceAreaIsExactlyZeroWhenVerticesCoincideOrLieOnALine) {
  EXPECT_EQ(twice_area({Eigen::Vector3d{0.1, 0.2, 0.3}, {0.1, 0.2, 0.3}, {1, 2, 5}}), 0);
  EXPECT_EQ(twice_area({Eigen::Vector3d{0, 0, 0}, {1, 2, 3}, {3, 6, 9}}), 0);
}

TEST(Triangle, SignedVolumeOfACubeFarFromTheOriginIsItsEdgeCubed) {
  std::vector<Triangle> cube = triangulate(Cuboid{2, 2, 2});
  for (Triangle& triangle : cube)
    for (Eigen::Vector3d& vertex : triangle)
      vertex += Eigen::Vector3d(1e6, -1e6, 1e6);
  EXPECT_DOUBLE_EQ(signed_volume(cube), 8);
  for (Triangle& triangle : cube)
    std::swap(triangle[0], triangle[1]);
  EXPECT_DOUBLE_EQ(signed_volume(cube), -8);
}

TEST(Triangle, ASurfaceIsClosedWhenEveryEdgeIsUsedInBothDirections) {
  std::vector<Triangle> cube = triangulate(Cuboid{1, 1, 1});
  EXPECT_TRUE(is_closed(cube));
  cube.pop_back();
  EXPECT_FALSE(is_closed(cube));
  EXPECT_FALSE(is_closed(triangulate(Plate{1, 1})));
  EXPECT_FALSE(is_closed({}));
}

TEST(Triangle, WithoutDuplicatesKeepsTheFirstOfTrianglesWithTheSameVertices) {
  const Eigen::Vector3d a(0, 0, 0), b(1, 0, 0), c(0, 1, 0), d(0, 0, 1);
  const std::vector<Triangle> triangles{{a, b, c}, {a, b, d}, {c, a, b}, {Eigen::Vector3d(-0.0, 0, 0), c, b}};
  EXPECT_EQ(without_duplicates(triangles), (std::vector<Triangle>{{a, b, c}, {a, b, d}}));
  EXPECT_EQ(without_duplicates(triangles, Sides::distinct).size(), 3U) << "the last one faces the other way";
}

TEST(Triangle, AxisAlignedBoxHoldsEveryVertex) {
  const std::vector<Triangle> triangles{{Eigen::Vector3d{1, 2, 3}, {-1, 5, 0}, {0, 0, 7}}};
  const Eigen::AlignedBox3d box = axis_aligned_box(triangles);
  EXPECT_EQ(box.min(), Eigen::Vector3d(-1, 0, 0));
  EXPECT_EQ(box.max(), Eigen::Vector3d(1, 5, 7));
}

TEST(Rectangle, MayBeOffARightAngleByOnePartInABillion) {
  EXPECT_NO_THROW(validate(Rectangle{{1, 2, 3}, {0.1, 0, 0}, {0, 7e3, 0}}));
  EXPECT_NO_THROW(validate(Rectangle{{0, 0, 0}, {1, 0, 0}, {0.9e-9, 1, 0}}));
  EXPECT_THROW(validate(Rectangle{{0, 0, 0}, {1, 0, 0}, {1.1e-9, 1, 0}}), InputError);
}

TEST(Rectangle, IsSquaredByTurningBothEdgesByHalf) {
  const double angle = 8e-5;
  const Rectangle drawn{{1, 2, 3}, {0.3, 0, 0}, {-0.2 * std::sin(angle), 0, 0.2 * std::cos(angle)}};
  EXPECT_NEAR(cosine_between_edges(drawn), -angle, 1e-12);
  const Rectangle square = squared(drawn);
  EXPECT_EQ(square.corner, drawn.corner);
  EXPECT_NO_THROW(validate(square));
  EXPECT_LT(std::abs(cosine_between_edges(square)), 1e-15);
  EXPECT_NEAR(square.edge_u.norm(), 0.3, 1e-16);
  EXPECT_NEAR(square.edge_v.norm(), 0.2, 1e-16);
  EXPECT_NEAR(std::atan2(square.edge_u.z(), square.edge_u.x()), angle / 2, 1e-15);
  EXPECT_NEAR(std::atan2(-square.edge_v.x(), square.edge_v.z()), angle / 2, 1e-15);
}

TEST(Rectangle, IsSquaredAtAnySize) {
  for (const double size : {1e-300, 1e-160, 1e30})
    EXPECT_LT(std::abs(cosine_between_edges(squared({{0, 0, 0}, {size, 0, 0}, {5e-5 * size, size, 0}}))),
              1e-15)
        << size;
}

TEST(Rectangle, MustBeFiniteAndHaveTwoEdges) {
  const double nan = std::numeric_limits<double>::quiet_NaN(),
               infinity = std::numeric_limits<double>::infinity(),
               largest = std::numeric_limits<double>::max();
  for (const Rectangle& wrong :
       {Rectangle{{0, 0, 0}, {0, 0, 0}, {0, 1, 0}}, Rectangle{{0, 0, 0}, {1, 0, 0}, {0, 0, 0}},
        Rectangle{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}}, Rectangle{{nan, 0, 0}, {1, 0, 0}, {0, 1, 0}},
        Rectangle{{0, 0, 0}, {infinity, 0, 0}, {0, 1, 0}}, Rectangle{{0, 0, 0}, {1, 0, 0}, {0, 1, nan}},
        Rectangle{{0, 0, 0}, {largest, largest, 0}, {0, 0, 1}}})
    EXPECT_THROW(validate(wrong), InputError);
}

TEST(TriangleSlices, MakeUpTheTriangleAndLieBetweenTheirLevels) {
  test::Random random(1);
  constexpr double rounding = 1e-12;
  for (int i = 0; i < 500; ++i) {
    const Triangle triangle = random.triangle_in_box({-1, -1, -1}, {1, 1, 1});
    const Vector3d gradient = random.in_box({-1, -1, -1}, {1, 1, 1});
    const auto value = [&](const Vector3d& point) { return gradient.dot(point); };
    const double a = random.uniform(-1, 1), b = random.uniform(-1, 1), low = std::min(a, b),
                 high = std::max(a, b);
    const Slices parts =
        slices(triangle, {value(triangle[0]), value(triangle[1]), value(triangle[2])}, low, high);
    double sum = 0;
    const auto expect_between = [&](const Slice& slice, double from, double to) {
      for (const Triangle& part : slice) {
        sum += twice_area(part);
        for (const Vector3d& corner : part)
          EXPECT_TRUE(value(corner) > from - rounding && value(corner) < to + rounding);
      }
    };
    expect_between(parts.below, -10, low);
    expect_between(parts.between, low, high);
    expect_between(parts.above, high, 10);
    EXPECT_NEAR(sum, twice_area(triangle), rounding);
  }
}

TEST(TriangleSlices, ATriangleAtALevelIsNotBetween) {
  const Triangle triangle{Vector3d(0, 0, 0), Vector3d(1, 0, 0), Vector3d(0, 1, 0)};
  for (const double level : {2.0, 3.0}) {
    const Slices parts = slices(triangle, Vector3d::Constant(level), 2, 3);
    EXPECT_EQ(parts.between.size, 0U);
    EXPECT_EQ(parts.below.size + parts.above.size, 1U);
  }
  const Slices with_an_edge = slices(triangle, {2, 2, 3}, 2, 3);
  EXPECT_EQ(with_an_edge.between.size, 1U);
  EXPECT_EQ(with_an_edge.below.size + with_an_edge.above.size, 0U);
}

TEST(TriangleSlices, HalvesAreEqualAndNoLongerThanTheTriangle) {
  test::Random random(2);
  const auto longest = [](const Triangle& triangle) {
    return std::max({(triangle[1] - triangle[0]).norm(), (triangle[2] - triangle[1]).norm(),
                     (triangle[0] - triangle[2]).norm()});
  };
  for (int i = 0; i < 100; ++i) {
    const Triangle triangle = random.triangle_in_box({-1, -1, -1}, {1, 1, 1});
    const Vector3d normal = (triangle[1] - triangle[0]).cross(triangle[2] - triangle[0]);
    for (const Triangle& half : halves(triangle)) {
      // The half has the same normal, seen from the same side.
      const Vector3d own = (half[1] - half[0]).cross(half[2] - half[0]);
      EXPECT_LT((own - normal / 2).norm(), 1e-12);
      EXPECT_LT(longest(half), longest(triangle));
    }
  }
}

// Pieces in the cells are tested where they are integrated: Pieces, and plate_integral_stress.
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
