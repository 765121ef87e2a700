#include "geometry/surface_mesh.hpp"

#include <limits>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "fringe/triangulation.hpp"

namespace fringe::detail::FRINGE_TEST_FILE {
namespace {

using Eigen::Vector3d;
using testing::ElementsAre;
using testing::UnorderedElementsAre;

const Vector3d origin(0, 0, 0), east(1, 0, 0), north(0, 1, 0), north_east(1, 1, 0);

TEST(SurfaceMesh, MergesCornersWithEqualCoordinates) {
  const std::vector<Triangle> square{{origin, east, north_east}, {origin, north_east, north}};
  const SurfaceMesh mesh(square);
  EXPECT_THAT(mesh.vertices(), ElementsAre(origin, north, east, north_east));
  EXPECT_THAT(mesh.faces(), ElementsAre(SurfaceMesh::Face{0, 2, 3}, SurfaceMesh::Face{0, 3, 1}));
  ASSERT_EQ(mesh.edges().size(), 5U);
  EXPECT_THAT(mesh.neighbours(), ElementsAre(ElementsAre(1U), ElementsAre(0U)));
  EXPECT_FALSE(mesh.is_closed());
}

TEST(SurfaceMesh, NegativeZeroIsZero) {
  const std::vector<Triangle> square{{origin, east, north_east},
                                     {Vector3d(-0.0, 0, -0.0), north_east, north}};
  EXPECT_EQ(SurfaceMesh(square).vertices().size(), 4U);
}

TEST(SurfaceMesh, KnowsTheFacesAroundEveryEdgeOfACube) {
  const std::vector<Triangle> cube = triangulate(Cuboid{1, 1, 1});
  const SurfaceMesh mesh(cube);
  EXPECT_EQ(mesh.vertices().size(), 8U);
  EXPECT_EQ(mesh.edges().size(), 18U);
  for (const SurfaceMesh::Edge& edge : mesh.edges()) {
    EXPECT_LT(edge.from, edge.to);
    EXPECT_EQ(edge.faces.size(), 2U);
    EXPECT_EQ(edge.balance, 0);
  }
  for (const auto& neighbours : mesh.neighbours())
    EXPECT_EQ(neighbours.size(), 3U);
  EXPECT_TRUE(mesh.is_closed());
}

TEST(SurfaceMesh, ListsAllFacesAtAnEdgeThatManyShare) {
  const std::vector<Triangle> fan{
      {origin, east, north}, {origin, east, north_east}, {east, origin, {0, 0, 1}}};
  const SurfaceMesh mesh(fan);
  for (const SurfaceMesh::Edge& edge : mesh.edges()) {
    if (mesh.vertices()[edge.from] == origin && mesh.vertices()[edge.to] == east) {
      EXPECT_THAT(edge.faces, ElementsAre(0U, 1U, 2U));
      EXPECT_EQ(edge.balance, 1);
    }
  }
  EXPECT_THAT(mesh.neighbours()[0], UnorderedElementsAre(1U, 2U));
}

TEST(SurfaceMesh, TakesFacesWithoutAreaAndCornersThatAreNoNumbers) {
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(SurfaceMesh(std::vector<Triangle>{{origin, origin, origin}}).is_closed());
  const SurfaceMesh mesh(
      std::vector<Triangle>{{origin, Vector3d(nan, 0, 0), east}, {east, Vector3d(nan, 0, 0), origin}});
  EXPECT_EQ(mesh.vertices().size(), 3U);
  EXPECT_FALSE(SurfaceMesh({}).is_closed());
}

}  // namespace
}  // namespace fringe::detail::FRINGE_TEST_FILE
