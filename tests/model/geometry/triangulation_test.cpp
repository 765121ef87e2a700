#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <vector>

#include <gmock/gmock.h>

#include "fringe/shape.hpp"
#include "fringe/triangulation.hpp"
#include "geometry.hpp"
#include "geometry/surface_mesh.hpp"

/// The triangles of shapes, what they enclose, and which of them are neighbours.
namespace fringe::detail::FRINGE_TEST_FILE {
namespace {

using Eigen::Vector3d;
using std::numbers::pi;
using testing::ElementsAre;

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
  EXPECT_THAT(triangulate(Plate{4, 2}), ElementsAre(Triangle{Vector3d{-2, -1, 0}, {2, -1, 0}, {2, 1, 0}},
                                                    Triangle{Vector3d{-2, -1, 0}, {2, 1, 0}, {-2, 1, 0}}));
}

/// Checks how many triangles bound a body, and that it is closed.
void expect_body(const std::vector<Triangle>& triangles, std::size_t count, double volume, double surface) {
  EXPECT_EQ(triangles.size(), count);
  EXPECT_NEAR(signed_volume(triangles), volume, 1e-13);
  EXPECT_NEAR(area(triangles), surface, 1e-13);
  EXPECT_TRUE(is_closed(triangles));
}

TEST(Triangulation, OfACuboidHasItsAreaAndVolume) {
  const std::vector<Triangle> triangles = triangulate(Cuboid{2, 3, 5});
  expect_body(triangles, 12, 2 * 3 * 5, 2 * (2 * 3 + 3 * 5 + 5 * 2));
  expect_outward(triangles, {0, 0, 0});
  EXPECT_EQ(triangles[0], (Triangle{Vector3d{-1, -1.5, -2.5}, {-1, 1.5, -2.5}, {1, 1.5, -2.5}}))
      << "-z first";
  EXPECT_EQ(triangles[11], (Triangle{Vector3d{1, -1.5, -2.5}, {1, 1.5, 2.5}, {1, -1.5, 2.5}})) << "+x last";
}

TEST(Triangulation, OfACylinderIsAnInscribedPrismOfAConeAPyramid) {
  const double r = 0.3, h = 2;
  for (const std::size_t n : {3, 8, 48}) {
    const int segments = static_cast<int>(n);
    const double base = polygon_area(r, segments), edge = side(r, segments);
    const std::vector<Triangle> prism = triangulate(Cylinder{r, h, segments}),
                                pyramid = triangulate(Cone{r, h, segments});
    expect_body(prism, 4 * n, base * h, 2 * base + segments * edge * h);
    expect_outward(prism, {0, 0, 0});
    const double slant = std::hypot(h, r * std::cos(pi / segments));
    expect_body(pyramid, 2 * n, base * h / 3, base + segments * edge * slant / 2);
    expect_outward(pyramid, {0, 0, 0});
    EXPECT_EQ(pyramid[0][2], Vector3d(0, 0, h / 2)) << "the base is below";
  }
}

TEST(Triangulation, OfAnArcIsARingSectorWithEndsOrAClosedRing) {
  const double inner = 0.5, outer = 0.8, h = 0.2;
  const int n = 10;
  const auto base = [&](double angle) {
    return polygon_area(outer, n, angle) - polygon_area(inner, n, angle);
  };
  const auto walls = [&](double angle) { return n * (side(outer, n, angle) + side(inner, n, angle)) * h; };
  const double angle = 2 * pi / 3, whole = 2 * pi;
  const std::vector<Triangle> sector = triangulate(Arc{inner, outer, h, 120, n});
  expect_body(sector, 8 * n + 4, base(angle) * h, 2 * base(angle) + walls(angle) + 2 * (outer - inner) * h);
  // The arc is symmetric about the xz plane, from −60° to +60°.
  const Eigen::AlignedBox3d box = axis_aligned_box(sector);
  EXPECT_NEAR(box.max().y(), outer * std::sin(angle / 2), 1e-15);
  EXPECT_NEAR(box.min().y(), -box.max().y(), 1e-15);
  EXPECT_GT(box.min().x(), 0);
  expect_body(triangulate(Arc{inner, outer, h, 360, n}), 8 * n, base(whole) * h,
              2 * base(whole) + walls(whole));
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
  EXPECT_THAT(mesh.neighbours()[0], testing::UnorderedElementsAre(1U, 2U));
}

TEST(SurfaceMesh, TakesFacesWithoutAreaAndCornersThatAreNoNumbers) {
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(SurfaceMesh(std::vector<Triangle>{{origin, origin, origin}}).is_closed());
  const SurfaceMesh mesh(
      std::vector<Triangle>{{origin, Vector3d(nan, 0, 0), east}, {east, Vector3d(nan, 0, 0), origin}});
  EXPECT_EQ(mesh.vertices().size(), 3U);
  EXPECT_FALSE(SurfaceMesh({}).is_closed());
}

TEST(WindingNumber, TellsTheInsideOfABoxAndOfAnArc) {
  test::Random random(1);
  const std::vector<Triangle> box = triangulate(Cuboid{1, 2, 3}), arc = triangulate(Arc{0.5, 1, 1, 90, 16});
  for (int i = 0; i < 500; ++i) {
    const Vector3d point = random.in_box({-1, -1.5, -2}, {1, 1.5, 2});
    EXPECT_EQ(is_in_polyhedron(box, point),
              std::abs(point.x()) < 0.5 && std::abs(point.y()) < 1 && std::abs(point.z()) < 1.5);
    // The arc is not convex: its hollow is outside. Between a chord and its arc no one is asked.
    const double radius = point.head<2>().norm(), angle = std::atan2(point.y(), point.x());
    const double shrink = std::cos(EIGEN_PI / 64);
    const bool is_in_sector = std::abs(point.z()) < 0.5 && std::abs(angle) < EIGEN_PI / 4;
    if (is_in_sector && radius > 0.5 && radius < shrink) {
      EXPECT_TRUE(is_in_polyhedron(arc, point)) << point.transpose();
    }
    if (!is_in_sector || radius > 1 || radius < 0.5 * shrink) {
      EXPECT_FALSE(is_in_polyhedron(arc, point)) << point.transpose();
    }
  }
}

TEST(WindingNumber, IsKnownOnCornersAndEdgesOfAShellInsideAnother) {
  std::vector<Triangle> shells = triangulate(Cuboid{1, 2, 3});
  const std::vector<Triangle> inner = triangulate(Cuboid{0.25, 0.25, 0.25});
  shells.insert(shells.end(), inner.begin(), inner.end());
  for (const Vector3d& point : {Vector3d(0.125, 0.125, 0.125), Vector3d(0.125, 0.125, 0.0625)})
    EXPECT_TRUE(is_in_polyhedron(shells, point)) << point.transpose();
}

}  // namespace
}  // namespace fringe::detail::FRINGE_TEST_FILE
