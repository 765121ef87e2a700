#include "fringe/triangulation.hpp"
#include "geometry/surface_mesh.hpp"

#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace fringe::detail::FRINGE_TEST_FILE {
namespace {

using Eigen::Vector3d;
using std::numbers::pi;
using testing::ElementsAre;
using testing::UnorderedElementsAre;

/// Computes the area of the regular polygon with n corners on a circle, or of a circular sector approximated
/// by n triangles.
double polygon_area(double radius, int n, double angle = 2 * pi) {
  return n * radius * radius * std::sin(angle / n) / 2;
}

/// Computes the side length of that polygon.
double side(double radius, int n, double angle = 2 * pi) {
  return 2 * radius * std::sin(angle / n / 2);
}

/// Checks that every face of a body that is star-shaped about `inside` faces outward.
void expect_outward(const std::vector<Triangle>& triangles, const Vector3d& inside) {
  for (const auto& [a, b, c] : triangles)
    EXPECT_GT((b - a).cross(c - a).dot(a - inside), 0);
}

TEST(Triangulation, OfAPlateIsTwoTrianglesThatFaceUp) {
  const std::vector<Triangle> triangles = triangulate(Plate{4, 2});
  ASSERT_EQ(triangles.size(), 2U);
  EXPECT_EQ(triangles[0], (Triangle{Vector3d{-2, -1, 0}, {2, -1, 0}, {2, 1, 0}}));
  EXPECT_EQ(triangles[1], (Triangle{Vector3d{-2, -1, 0}, {2, 1, 0}, {-2, 1, 0}}));
  EXPECT_DOUBLE_EQ(area(triangles), 8);
}

TEST(Triangulation, OfACuboidHasItsAreaAndVolume) {
  const std::vector<Triangle> triangles = triangulate(Cuboid{2, 3, 5});
  EXPECT_EQ(triangles.size(), 12U);
  EXPECT_EQ(triangles[0], (Triangle{Vector3d{-1, -1.5, -2.5}, {-1, 1.5, -2.5}, {1, 1.5, -2.5}}))
      << "-z first";
  EXPECT_EQ(triangles[11], (Triangle{Vector3d{1, -1.5, -2.5}, {1, 1.5, 2.5}, {1, -1.5, 2.5}})) << "+x last";
  EXPECT_DOUBLE_EQ(area(triangles), 2 * (2 * 3 + 3 * 5 + 5 * 2));
  EXPECT_DOUBLE_EQ(signed_volume(triangles), 2 * 3 * 5);
  EXPECT_TRUE(is_closed(triangles));
  expect_outward(triangles, {0, 0, 0});
}

TEST(Triangulation, OfACylinderIsAnInscribedPrism) {
  const double r = 0.3, h = 2;
  for (const int n : {3, 8, 48}) {
    const std::vector<Triangle> triangles = triangulate(Cylinder{r, h, n});
    EXPECT_EQ(triangles.size(), 4U * n);
    EXPECT_NEAR(area(triangles), 2 * polygon_area(r, n) + n * side(r, n) * h, 1e-13);
    EXPECT_NEAR(signed_volume(triangles), polygon_area(r, n) * h, 1e-13);
    EXPECT_TRUE(is_closed(triangles));
    expect_outward(triangles, {0, 0, 0});
  }
}

TEST(Triangulation, OfAConeIsAnInscribedPyramidWithItsBaseBelow) {
  const double r = 0.3, h = 2;
  for (const int n : {3, 8, 48}) {
    const std::vector<Triangle> triangles = triangulate(Cone{r, h, n});
    EXPECT_EQ(triangles.size(), 2U * n);
    EXPECT_EQ(triangles[0][2], Vector3d(0, 0, h / 2));
    EXPECT_NEAR(signed_volume(triangles), polygon_area(r, n) * h / 3, 1e-13);
    EXPECT_TRUE(is_closed(triangles));
    expect_outward(triangles, {0, 0, 0});
  }
}

TEST(Triangulation, OfAnArcIsARingSectorWithEnds) {
  const double inner = 0.5, outer = 0.8, h = 0.2, degrees = 120, angle = degrees * pi / 180;
  const int n = 10;
  const std::vector<Triangle> triangles = triangulate(Arc{inner, outer, h, degrees, n});
  EXPECT_EQ(triangles.size(), 8U * n + 4);
  const double base = polygon_area(outer, n, angle) - polygon_area(inner, n, angle);
  EXPECT_NEAR(signed_volume(triangles), base * h, 1e-14);
  EXPECT_NEAR(area(triangles),
              2 * base + n * (side(outer, n, angle) + side(inner, n, angle)) * h + 2 * (outer - inner) * h,
              1e-14);
  EXPECT_TRUE(is_closed(triangles));
  // The arc is symmetric about the xz plane, from −60° to +60°.
  const Eigen::AlignedBox3d box = axis_aligned_box(triangles);
  EXPECT_NEAR(box.max().y(), outer * std::sin(angle / 2), 1e-15);
  EXPECT_NEAR(box.min().y(), -box.max().y(), 1e-15);
  EXPECT_GT(box.min().x(), 0);
}

TEST(Triangulation, OfAFullArcIsAClosedRing) {
  const int n = 12;
  const std::vector<Triangle> triangles = triangulate(Arc{0.5, 0.8, 0.2, 360, n});
  EXPECT_EQ(triangles.size(), 8U * n);
  EXPECT_NEAR(signed_volume(triangles), (polygon_area(0.8, n) - polygon_area(0.5, n)) * 0.2, 1e-14);
  EXPECT_TRUE(is_closed(triangles));
}

TEST(Triangulation, OfASphereIsInscribedAndConvergesToIt) {
  const double r = 0.7;
  for (const int n : {3, 4, 7, 48}) {
    const std::vector<Triangle> triangles = triangulate(Sphere{r, n});
    const int bands = std::max(2, n / 2);
    EXPECT_EQ(triangles.size(), 2U * n * (bands - 1));
    EXPECT_EQ(triangles.front()[0], Vector3d(0, 0, r));
    EXPECT_EQ(triangles.back()[0], Vector3d(0, 0, -r));
    EXPECT_TRUE(is_closed(triangles));
    expect_outward(triangles, {0, 0, 0});
    for (const Triangle& triangle : triangles)
      for (const Vector3d& vertex : triangle)
        EXPECT_NEAR(vertex.norm(), r, 1e-15);
  }
  // The inscribed body's volume is too small by an amount proportional to 1/n².
  const double volume = 4 * pi / 3 * r * r * r;
  const double coarse = volume - signed_volume(triangulate(Sphere{r, 48}));
  const double fine = volume - signed_volume(triangulate(Sphere{r, 96}));
  EXPECT_NEAR(coarse / fine, 4, 0.02);
}

TEST(Triangulation, OfAnEllipsoidIsAStretchedBall) {
  const Vector3d semi_axes(0.7, 0.2, 0.4);
  const std::vector<Triangle> triangles = triangulate(Ellipsoid{0.7, 0.2, 0.4, 10}),
                              ball = triangulate(Sphere{1, 10});
  ASSERT_EQ(triangles.size(), ball.size());
  for (std::size_t k = 0; k < ball.size(); ++k)
    for (std::size_t i = 0; i < 3; ++i)
      EXPECT_EQ(triangles[k][i], ball[k][i].cwiseProduct(semi_axes));
  EXPECT_TRUE(is_closed(triangles));
}

/// Computes the volume of a box with these sides swept by a ball (Steiner's formula).
double swept_volume(const Vector3d& sides, double r) {
  const double faces = sides.x() * sides.y() + sides.y() * sides.z() + sides.z() * sides.x();
  return sides.prod() + 2 * r * faces + pi * r * r * sides.sum() + 4 * pi / 3 * r * r * r;
}

/// Checks that triangles are those of a swept box: closed, outward, with area, on its surface, and with a
/// volume too small by an amount proportional to 1/n².
void expect_swept(const Vector3d& core, double r, const std::function<Shape(int)>& make) {
  for (const int n : {3, 4, 11, 48}) {
    const std::vector<Triangle> triangles = triangulate(make(n));
    EXPECT_TRUE(is_closed(triangles)) << n;
    expect_outward(triangles, {0, 0, 0});
    for (const Triangle& triangle : triangles)
      for (const Vector3d& vertex : triangle)
        EXPECT_NEAR((vertex.cwiseAbs() - core).cwiseMax(0).norm(), r, 1e-15);
  }
  const double volume = swept_volume(2 * core, r);
  const double coarse = volume - signed_volume(triangulate(make(48)));
  const double fine = volume - signed_volume(triangulate(make(96)));
  EXPECT_NEAR(coarse / fine, 4, 0.02);
}

TEST(Triangulation, OfACapsuleIsInscribedAndConvergesToIt) {
  expect_swept({0, 0, 0.5}, 0.3, [](int n) { return Capsule{0.3, 1, n}; });
  EXPECT_EQ(triangulate(Capsule{0.3, 1, 51}).size(), 48U * 48U);
}

TEST(Triangulation, OfARoundedCuboidIsInscribedWhateverSidesAreLeftFlat) {
  expect_swept({1, 0.5, 0.75}, 0.25, [](int n) { return RoundedCuboid{2.5, 1.5, 2, 0.25, n}; });
  expect_swept({1, 0.5, 0}, 0.25, [](int n) { return RoundedCuboid{2.5, 1.5, 0.5, 0.25, n}; });
  expect_swept({0, 0.5, 0.75}, 0.25, [](int n) { return RoundedCuboid{0.5, 1.5, 2, 0.25, n}; });
  expect_swept({0, 0.5, 0}, 0.25, [](int n) { return RoundedCuboid{0.5, 1.5, 0.5, 0.25, n}; });
  expect_swept({0, 0, 0}, 0.25, [](int n) { return RoundedCuboid{0.5, 0.5, 0.5, 0.25, n}; });
}

TEST(Triangulation, OfADiscIsARegularPolygonThatFacesUp) {
  const std::vector<Triangle> triangles = triangulate(Disc{0.3, 7});
  EXPECT_EQ(triangles.size(), 7U);
  EXPECT_NEAR(area(triangles), polygon_area(0.3, 7), 1e-15);
  for (const auto& [a, b, c] : triangles)
    EXPECT_GT((b - a).cross(c - a).z(), 0);
}

TEST(Triangulation, OfAMeshIsTheMesh) {
  const Triangle triangle{Vector3d{1, 2, 3}, {4, 5, 6}, {7, 8, 10}};
  EXPECT_EQ(triangulate(Mesh{"x.stl", 1, {triangle}}), std::vector<Triangle>{triangle});
}

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
