#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "collision/bounding_volume.hpp"
#include "collision/convex_pieces.hpp"
#include "fringe/bounding_volume.hpp"
#include "fringe/convex_shape.hpp"
#include "fringe/error.hpp"
#include "fringe/gjk.hpp"
#include "fringe/triangulation.hpp"
#include "geometry/surface_mesh.hpp"
#include "real.hpp"
#include "shape_pairs.hpp"

/// Volumes around points, the axes of boxes, and convex pieces of shapes in their boxes.
namespace fringe::FRINGE_TEST_FILE {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using namespace test;

constexpr double epsilon = std::numeric_limits<double>::epsilon();
/// Relative allowance: twice the outward rounding of volumes plus the rounding of a height.
constexpr double outward = 20 * epsilon;

/// Returns the vertices of a random shape from the classes of difficult pairs.
Points random_points(Random& random) {
  const auto classes = pair_classes();
  const auto [a, b] = classes[below(random, classes.size())].make(random);
  return a;
}

RealVector from_centre(const Vector3d& centre, const Vector3d& point) {
  return point.cast<Real>() - centre.cast<Real>();
}

bool strictly_inside(const Vector3d& point, const BoundingSphere& sphere) {
  return from_centre(sphere.centre, point).squaredNorm() < Real(sphere.radius) * sphere.radius;
}

bool strictly_inside(const Vector3d& point, const OrientedBox& box) {
  const RealVector heights = box.axes.cast<Real>() * from_centre(box.centre, point);
  return (heights.array() < box.half_widths.cast<Real>().array()).all() &&
         (-heights.array() < box.half_widths.cast<Real>().array()).all();
}

void expect_orthonormal_and_right_handed(const Eigen::Matrix3d& axes) {
  EXPECT_LE((axes * axes.transpose() - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff(), 4 * epsilon);
  EXPECT_GT(axes.determinant(), 0);
}

double volume(const OrientedBox& box) {
  return 8 * box.half_widths.prod();
}

/// Returns the corners of a box with one corner at the origin.
Points box_corners(const Vector3d& size) {
  return placed({corners_of_box(size / 2), {}}, 1, size / 2).a;
}

Points united(Points points, const Points& others) {
  points.insert(points.end(), others.begin(), others.end());
  return points;
}

/// Returns rings of points about the z axis, as of a cylinder's base and top or of a sector of a ring.
Points rings(double inner, double outer, double height, double degrees, int segments) {
  Points points;
  for (int i = 0; i <= segments; ++i) {
    const double angle = degrees * std::numbers::pi / 180 * i / segments;
    for (const double radius : {inner, outer})
      for (const double z : {-height / 2, height / 2})
        points.emplace_back(radius * std::cos(angle), radius * std::sin(angle), z);
  }
  return points;
}

constexpr BoxMethod methods[] = {BoxMethod::vertices, BoxMethod::triangles, BoxMethod::tight};

TEST(BoundingVolumes, ContainEveryVertexStrictly) {
  Random random(1);
  for (int i = 0; i < draws(200); ++i) {
    const Points points = random_points(random);
    for (const int exponent : {0, -900, 900}) {
      const Points scaled = placed({points, {}}, std::ldexp(1.0, exponent), Vector3d::Zero()).a;
      const BoundingSphere sphere = bounding_sphere(scaled);
      for (const Vector3d& point : scaled)
        ASSERT_TRUE(strictly_inside(point, sphere)) << i;
      for (const BoxMethod method : methods) {
        const OrientedBox box = oriented_box(scaled, {}, method);
        expect_orthonormal_and_right_handed(box.axes);
        for (const Vector3d& point : scaled)
          ASSERT_TRUE(strictly_inside(point, box)) << i;
      }
    }
  }
}

TEST(BoundingVolumes, EncloseAPointASegmentAndAFlatShape) {
  const std::vector<Points> shapes{{{1, 2, 3}},
                                   {{1, 2, 3}, {1, 2, 3}},
                                   {{0, 0, 0}},
                                   {{1, 2, 3}, {2, 3, 4}},
                                   {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, -1}}};
  for (const Points& points : shapes) {
    double size = 0;
    for (const Vector3d& point : points)
      size = std::max(size, (point - points[0]).norm());
    for (const BoxMethod method : methods) {
      const OrientedBox box = oriented_box(points, {}, method);
      expect_orthonormal_and_right_handed(box.axes);
      EXPECT_LE(box.half_widths.minCoeff(), outward * size + epsilon);
      EXPECT_LE(box.half_widths.norm(), (1 + outward) * size + epsilon);
      for (const Vector3d& point : points)
        EXPECT_TRUE(strictly_inside(point, box));
    }
    EXPECT_LE(bounding_sphere(points).radius, (1 + outward) * size + epsilon);
  }
}

TEST(BoundingSphere, IsTheSmallest) {
  // Its centre is in the hull of the points on its boundary: moving it in any direction takes it farther from
  // one of them.
  Random random(2);
  for (int i = 0; i < draws(300); ++i) {
    const Points points = random_points(random);
    const BoundingSphere sphere = bounding_sphere(points);
    double largest = 0;
    for (const Vector3d& point : points)
      largest = std::max(largest, point.norm());
    Points boundary;
    for (const Vector3d& point : points)
      if ((point - sphere.centre).norm() >
          sphere.radius - 1e-13 * largest - std::numeric_limits<double>::min())
        boundary.push_back(point);
    ASSERT_FALSE(boundary.empty());
    // A centre whose distances have an error of 1e-13 may itself have an error of its square root across a
    // flat direction.
    ASSERT_LE(gjk_distance(boundary, Points{sphere.centre}).distance, 1e-6 * largest) << i;
  }
}

TEST(OrientedBox, FollowsTheSurfaceRatherThanTheVertices) {
  // Most vertices of this flat bar crowd along a short diagonal, which does not change its surface.
  Points points{{0, 0, 0}, {4, 0, 0}, {4, 1, 0}, {0, 1, 0}};
  const std::vector<Face> faces{{0, 1, 2}, {0, 2, 3}};
  for (int i = 0; i < 100; ++i)
    points.emplace_back(0.01 * i, 0.01 * i, 0);
  const OrientedBox box = oriented_box(points, faces, BoxMethod::triangles);
  EXPECT_NEAR(std::abs(box.axes(0, 0)), 1, 1e-12);
  EXPECT_NEAR(box.half_widths.x(), 2, 1e-12);
  EXPECT_LT(std::abs(oriented_box(points, faces, BoxMethod::vertices).axes(0, 0)), 0.999);
}

/// A shape with the volume of the smallest known box around it, and by what share the tight box may be
/// larger.
struct KnownShape {
  const char* name;
  Points points;
  double smallest;
  double excess = 0.02;
};

std::vector<KnownShape> known_shapes() {
  const double cylinder_radius = 0.5;
  const int sides = 32;
  // If the number of sides of a regular polygon is divisible by four, the box aligned with its sides is a
  // square of twice the apothem.
  const double apothem = cylinder_radius * std::cos(std::numbers::pi / sides);
  return {{"cube", box_corners({1, 1, 1}), 1, 1e-13},
          {"cuboid", box_corners({1, 2, 3}), 6, 1e-13},
          {"long cuboid", box_corners({1, 0.01, 100}), 1},
          {"L-shape", united(box_corners({2, 1, 1}), box_corners({1, 1, 3})), 2 * 1 * 3},
          {"half ring", rings(0.5, 1, 0.2, 180, 32), 2 * 1 * 0.2},
          {"cylinder", rings(0, cylinder_radius, 3, 360, sides), 4 * apothem * apothem * 3},
          {"tetrahedron", {{1, 1, 1}, {-1, -1, 1}, {-1, 1, -1}, {1, -1, -1}}, 8}};
}

TEST(OrientedBox, ByTightMethodIsWithinTwoPercentOfTheSmallestKnownBoxInAnyRotation) {
  Random random(3);
  for (const auto& [name, points, smallest, excess] : known_shapes())
    for (int i = 0; i < draws(3); ++i) {
      const OrientedBox box = oriented_box(moved(points, random.rigid_motion()), {}, BoxMethod::tight);
      EXPECT_LE(volume(box), (1 + excess) * smallest) << name;
    }
}

TEST(BoundingVolumes, RefuseWrongInput) {
  const Points triangle{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  const std::vector<Face> wrong{{0, 1, 2}, {0, 1, 3}};
  EXPECT_THROW(bounding_sphere({}), InputError);
  EXPECT_THROW(axis_aligned_box(Points{{NAN, 0, 0}}), InputError);
  EXPECT_THROW(oriented_box(triangle, wrong, BoxMethod::tight), InputError);
  EXPECT_THROW(parse_box_method("loose"), InputError);
}

/// The volume of the smallest box with these axes (rows).
double volume_of_box(const std::vector<Vector3d>& points, const Matrix3d& axes) {
  Eigen::AlignedBox3d box;
  for (const Vector3d& point : points)
    box.extend(axes * point);
  return box.volume();
}

/// The faces of corners_of_box.
const std::vector<Face> faces_of_box{{0, 1, 3}, {0, 3, 2}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                                     {2, 3, 7}, {2, 7, 6}, {0, 2, 6}, {0, 6, 4}, {1, 3, 7}, {1, 7, 5}};

TEST(BoxAxes, AreThoseOfABoxHoweverItIsTurned) {
  Random random(1);
  const Vector3d half_widths(0.9, 0.4, 0.2);
  for (int i = 0; i < 30; ++i) {
    const Points points = moved(corners_of_box(half_widths), random.rigid_motion());
    for (const Matrix3d& axes :
         {detail::axes_of_vertices(points), detail::axes_of_triangles(points, faces_of_box),
          detail::tight_axes(points, faces_of_box), detail::tight_axes(points, {})}) {
      EXPECT_LT((axes * axes.transpose() - Matrix3d::Identity()).norm(), 1e-14);
      EXPECT_NEAR(volume_of_box(points, axes), 8 * half_widths.prod(), 1e-12);
    }
  }
}

/// Tells whether a point is in a piece of a shape.
bool is_in_pieces(const detail::ConvexPieces& pieces, const Vector3d& point) {
  const ConvexShape one_point = ConvexShape::hull(std::vector{point});
  for (const detail::ConvexPiece& piece : pieces.pieces)
    if (intersect(piece.shape, piece.pose, one_point, Eigen::Isometry3d::Identity()))
      return true;
  return false;
}

// The pieces are truly round, the triangles inscribed: points inside these are in a piece, and none outside
// of the box is.
TEST(ConvexPieces, ContainTheShapeAndLieInItsBox) {
  Random random(5);
  const std::vector<Shape> shapes{Cuboid{1, 0.5, 0.2},
                                  Cylinder{0.5, 0.4, 24},
                                  Cone{0.5, 0.8, 24},
                                  Arc{0.3, 0.5, 0.2, 300, 24},
                                  Sphere{0.5, 16},
                                  Capsule{0.2, 0.4, 16},
                                  Ellipsoid{0.5, 0.3, 0.2, 16},
                                  RoundedCuboid{1, 0.6, 0.4, 0.1, 8}};
  for (const Shape& shape : shapes) {
    const detail::ConvexPieces pieces = detail::convex_pieces(shape);
    const OrientedBox box = detail::enclosing_box(shape);
    const std::vector<Triangle> surface = triangulate(shape);
    int inside = 0;
    for (int k = 0; k < 200; ++k) {
      const Vector3d point = random.in_box({-0.6, -0.6, -0.6}, {0.6, 0.6, 0.6});
      const bool is_in_shape = detail::is_in_polyhedron(surface, point),
                 is_in_piece = is_in_pieces(pieces, point);
      inside += is_in_shape ? 1 : 0;
      EXPECT_TRUE(is_in_piece || !is_in_shape) << shape.index() << ": " << point.transpose();
      EXPECT_TRUE(!is_in_piece ||
                  ((box.axes * (point - box.centre)).cwiseAbs().array() <= box.half_widths.array()).all())
          << shape.index() << ": " << point.transpose();
    }
    EXPECT_GT(inside, 0) << shape.index();
  }
}

}  // namespace
}  // namespace fringe::FRINGE_TEST_FILE
