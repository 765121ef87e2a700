#include "fringe/mesh_defects.hpp"

#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "fringe/error.hpp"
#include "fringe/triangulation.hpp"
#include "geometry.hpp"

namespace fringe::FRINGE_TEST_FILE {
namespace {

using Eigen::Vector3d;

const Cuboid cube{2, 2, 2};

std::vector<Triangle> moved(const std::vector<Triangle>& triangles, double x, double y, double z) {
  return test::moved(triangles, Eigen::Isometry3d(Eigen::Translation3d(x, y, z)));
}

void append(std::vector<Triangle>& triangles, const std::vector<Triangle>& more) {
  triangles.insert(triangles.end(), more.begin(), more.end());
}

TEST(MeshDefects, ACubeIsOneShellWithoutDefects) {
  const MeshDefects found = mesh_defects(triangulate(cube));
  EXPECT_EQ(found.shells, 1U);
  EXPECT_EQ(found.without_area + found.duplicates + found.open_edges + found.branching_edges +
                found.flipped_edges + found.t_junctions + found.crossings,
            0U);
}

TEST(MeshDefects, AMissingAFlippedOrAThirdTriangleIsSeenAtItsEdges) {
  std::vector<Triangle> missing = triangulate(cube), flipped = missing, branching = missing;
  missing.pop_back();
  EXPECT_EQ(mesh_defects(missing).open_edges, 3U);
  std::swap(flipped[5][0], flipped[5][1]);
  EXPECT_EQ(mesh_defects(flipped).flipped_edges, 3U);
  EXPECT_EQ(mesh_defects(flipped).open_edges, 0U);
  branching.push_back({branching[0][0], branching[0][1], Vector3d(5, 6, 7)});
  EXPECT_EQ(mesh_defects(branching).branching_edges, 1U);
}

TEST(MeshDefects, DuplicatesAndFlatTrianglesHideNoOtherDefectAndAddNone) {
  std::vector<Triangle> triangles = triangulate(cube);
  Triangle reversed = triangles[3];
  std::swap(reversed[0], reversed[2]);
  append(triangles, {triangles[0], reversed, {Vector3d(1, 1, 1), {1, 1, 1}, {1, 1, -1}}});
  const MeshDefects found = mesh_defects(triangles);
  EXPECT_EQ(found.duplicates, 2U);
  EXPECT_EQ(found.without_area, 1U);
  EXPECT_EQ(found.open_edges + found.branching_edges + found.flipped_edges, 0U);
}

TEST(MeshDefects, AVertexInsideAnOpenEdgeIsATJunction) {
  const Vector3d middle(0.5, 0, 0);
  const MeshDefects found = mesh_defects(std::vector<Triangle>{{Vector3d(0, 0, 0), {1, 0, 0}, {0, 1, 0}},
                                                               {Vector3d(0, 0, 0), {0, -1, 0}, middle}});
  EXPECT_EQ(found.t_junctions, 1U);
  EXPECT_EQ(found.open_edges, 6U);
}

TEST(MeshDefects, ShellsThatCrossAreCountedWithThePairsOfTrianglesThatCross) {
  std::vector<Triangle> triangles = triangulate(cube);
  append(triangles, moved(triangles, 10, 0, 0));
  EXPECT_EQ(mesh_defects(triangles).shells, 2U);
  EXPECT_EQ(mesh_defects(triangles).crossings, 0U);
  // One corner of the third cube is inside the first one: three faces of each cross, which are six triangles.
  append(triangles, moved(triangulate(cube), 1.1, 1.2, 1.3));
  const MeshDefects found = mesh_defects(triangles);
  EXPECT_EQ(found.shells, 3U);
  EXPECT_GE(found.crossings, 6U);
  EXPECT_LE(found.crossings, 36U);
}

TEST(MeshDefects, CrossingsAreFoundExactlyHoweverSmall) {
  const Triangle floor{Vector3d(-1, -1, 0), {1, -1, 0}, {0, 1, 0}};
  const auto above = [&](double height) {
    return mesh_defects(std::vector<Triangle>{floor, {Vector3d(0, 0, height), {0.1, 0, 1}, {0, 0.1, 1}}});
  };
  EXPECT_EQ(above(0).crossings, 1U);
  EXPECT_EQ(above(std::numeric_limits<double>::min()).crossings, 0U);
}

TEST(MeshDefects, CoordinatesThatAreNotFiniteAreRefused) {
  std::vector<Triangle> triangles = triangulate(cube);
  triangles[7][1].z() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(mesh_defects(triangles), InputError);
}

}  // namespace
}  // namespace fringe::FRINGE_TEST_FILE
