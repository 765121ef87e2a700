#include "fringe/triangle.hpp"

#include <vector>

#include <gtest/gtest.h>

#include "fringe/triangulation.hpp"

namespace fringe::FRINGE_TEST_FILE {
namespace {

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

}  // namespace
}  // namespace fringe::FRINGE_TEST_FILE
