#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include <boost/multiprecision/cpp_int.hpp>
#include <gtest/gtest.h>

#include "collision/gjk_filter.hpp"
#include "fringe/bounding_volume.hpp"
#include "fringe/error.hpp"
#include "fringe/gjk.hpp"
#include "shape_pairs.hpp"
#include "simd/dispatch.hpp"

namespace fringe::FRINGE_TEST_FILE {
namespace {

using Eigen::Vector3d;
using test::draws;
using test::Points;
using test::Random;
using Rational = boost::multiprecision::cpp_rational;

constexpr double epsilon = std::numeric_limits<double>::epsilon();
/// Relative allowance: twice the outward rounding of volumes plus the rounding of a height.
constexpr double outward = 20 * epsilon;

/// Returns the vertices of a random shape from the classes of difficult pairs.
Points random_points(Random& random) {
  const auto classes = test::pair_classes();
  const auto [a, b] = classes[test::below(random, classes.size())].make(random);
  return a;
}

bool strictly_inside(const Vector3d& point, const BoundingSphere& sphere) {
  Rational square = 0;
  for (int k = 0; k < 3; ++k) {
    const Rational difference = Rational(point[k]) - Rational(sphere.centre[k]);
    square += difference * difference;
  }
  return square < Rational(sphere.radius) * Rational(sphere.radius);
}

bool strictly_inside(const Vector3d& point, const OrientedBox& box) {
  for (int i = 0; i < 3; ++i) {
    Rational height = 0;
    for (int k = 0; k < 3; ++k)
      height += Rational(box.axes(i, k)) * (Rational(point[k]) - Rational(box.centre[k]));
    if (abs(height) >= Rational(box.half_widths[i]))
      return false;
  }
  return true;
}

void expect_orthonormal_and_right_handed(const Eigen::Matrix3d& axes) {
  EXPECT_LE((axes * axes.transpose() - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff(), 4 * epsilon);
  EXPECT_GT(axes.determinant(), 0);
}

double volume(const OrientedBox& box) {
  return 8 * box.half_widths.prod();
}

Points box_corners(const Vector3d& size) {
  Points corners;
  for (const double x : {0.0, size.x()})
    for (const double y : {0.0, size.y()})
      for (const double z : {0.0, size.z()})
        corners.emplace_back(x, y, z);
  return corners;
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

Points turned(const Points& points, const Eigen::Isometry3d& motion) {
  Points result;
  for (const Vector3d& point : points)
    result.push_back(motion * point);
  return result;
}

constexpr BoxMethod methods[] = {BoxMethod::vertices, BoxMethod::triangles, BoxMethod::tight};

TEST(BoundingVolumes, ContainEveryVertexStrictly) {
  Random random(1);
  for (int i = 0; i < draws(200); ++i) {
    const Points points = random_points(random);
    for (const int exponent : {0, -900, 900}) {
      const Points scaled = test::placed({points, {}}, std::ldexp(1.0, exponent), Vector3d::Zero()).a;
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

TEST(BoundingSphere, IsTheKnownSmallestSphere) {
  // The smallest sphere of an obtuse triangle has the longest edge as its diameter; that of a regular
  // tetrahedron passes through all vertices.
  EXPECT_NEAR(bounding_sphere(Points{{-1, 0, 0}, {1, 0, 0}, {0, 0.5, 0}}).radius, 1, outward);
  EXPECT_NEAR(bounding_sphere(Points{{1, 1, 1}, {-1, -1, 1}, {-1, 1, -1}, {1, -1, -1}}).radius,
              std::sqrt(3.0), outward);
  EXPECT_NEAR(bounding_sphere(box_corners({1, 2, 3})).radius, std::sqrt(14.0) / 2, outward * 2);
}

TEST(BoundingSphere, HasItsCentreInTheHullOfThePointsOnItsBoundary) {
  // This property makes the sphere the smallest one: moving the centre in any direction takes it farther from
  // one of the points.
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

TEST(AxisAlignedBox, HasTheLeastAndTheLargestCoordinates) {
  const Eigen::AlignedBox3d box = axis_aligned_box(Points{{1, 5, -2}, {3, -4, 0}});
  EXPECT_EQ(box.min(), Vector3d(1, -4, -2));
  EXPECT_EQ(box.max(), Vector3d(3, 5, 0));
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

/// A shape with the volume of the smallest known box around it.
struct KnownShape {
  const char* name;
  Points points;
  double smallest;
};

std::vector<KnownShape> known_shapes() {
  const double cylinder_radius = 0.5;
  const int sides = 32;
  // If the number of sides of a regular polygon is divisible by four, the box aligned with its sides is a
  // square of twice the apothem.
  const double apothem = cylinder_radius * std::cos(std::numbers::pi / sides);
  return {{"cube", box_corners({1, 1, 1}), 1},
          {"cuboid", box_corners({1, 2, 3}), 6},
          {"long cuboid", box_corners({1, 0.01, 100}), 1},
          {"L-shape", united(box_corners({2, 1, 1}), box_corners({1, 1, 3})), 2 * 1 * 3},
          {"half ring", rings(0.5, 1, 0.2, 180, 32), 2 * 1 * 0.2},
          {"cylinder", rings(0, cylinder_radius, 3, 360, sides), 4 * apothem * apothem * 3},
          {"tetrahedron", {{1, 1, 1}, {-1, -1, 1}, {-1, 1, -1}, {1, -1, -1}}, 8}};
}

TEST(OrientedBox, ByTightMethodIsWithinTwoPercentOfTheSmallestKnownBoxInAnyRotation) {
  Random random(3);
  for (const auto& [name, points, smallest] : known_shapes())
    for (int i = 0; i < draws(10); ++i) {
      const OrientedBox box = oriented_box(turned(points, random.rigid_motion()), {}, BoxMethod::tight);
      EXPECT_LE(volume(box), 1.02 * smallest) << name;
    }
}

TEST(OrientedBox, ByTightMethodOfACubeIsTheCube) {
  Random random(4);
  for (int i = 0; i < draws(50); ++i) {
    const OrientedBox box =
        oriented_box(turned(box_corners({1, 1, 1}), random.rigid_motion()), {}, BoxMethod::tight);
    for (const double half_width : box.half_widths)
      EXPECT_NEAR(half_width, 0.5, 1e-14);
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

TEST(Overlap, IsTrueForTouchingSpheresAndBoxes) {
  EXPECT_TRUE(overlap(BoundingSphere{{0, 0, 0}, 1}, BoundingSphere{{3, 0, 0}, 2}));
  EXPECT_FALSE(overlap(BoundingSphere{{0, 0, 0}, 1}, BoundingSphere{{3.001, 0, 0}, 2}));
  const Eigen::AlignedBox3d unit(Vector3d(0, 0, 0), Vector3d(1, 1, 1));
  EXPECT_TRUE(overlap(unit, Eigen::AlignedBox3d{Vector3d(1, 1, 1), Vector3d(2, 2, 2)}));
  EXPECT_FALSE(overlap(unit, Eigen::AlignedBox3d{Vector3d(1 + epsilon, 0, 0), Vector3d(2, 2, 2)}));
}

Points corners_of(const OrientedBox& box) {
  Points corners;
  for (const Vector3d& t : box_corners({2, 2, 2}))
    corners.emplace_back(box.centre +
                         box.axes.transpose() * ((t.array() - 1) * box.half_widths.array()).matrix());
  return corners;
}

TEST(Overlap, OfOrientedBoxesAgreesWithTheirHulls) {
  Random random(5);
  int overlapping = 0;
  constexpr int repetitions = draws(20'000);
  for (int i = 0; i < repetitions; ++i) {
    const auto any_box = [&] {
      const Eigen::Isometry3d motion = random.rigid_motion();
      return OrientedBox{1.2 * motion.translation(), motion.linear(), random.in_box({0, 0, 0}, {1, 1, 1})};
    };
    const OrientedBox a = any_box(), b = any_box();
    const bool expected = gjk_intersects(corners_of(a), corners_of(b)).intersects;
    overlapping += expected;
    ASSERT_EQ(overlap(a, b), expected) << i;
    ASSERT_EQ(overlap(b, a), expected) << i;
  }
  EXPECT_GT(overlapping, repetitions / 10);
  EXPECT_LT(overlapping, repetitions * 9 / 10);
}

TEST(Overlap, OfOrientedBoxesIsTheSameForEveryInstructionSet) {
  Random random(31);
  const auto box = [&] {
    const Eigen::Isometry3d motion = random.rigid_motion();
    return OrientedBox{motion.translation(), motion.linear().transpose(),
                       random.in_box({0, 0, 0}, {0.8, 0.8, 0.8})};
  };
  const auto numbers = [](const OrientedBox& from) {
    detail::BoxNumbers result{};
    std::copy(from.centre.begin(), from.centre.end(), result.centre);
    std::copy(from.axes.data(), from.axes.data() + from.axes.size(), result.axes);
    std::copy(from.half_widths.begin(), from.half_widths.end(), result.half_widths);
    return result;
  };
  int overlapping = 0;
  constexpr int pairs = 2000;
  for (int i = 0; i < pairs; ++i) {
    const OrientedBox a = box(), b = box();
    overlapping += overlap(a, b);
    for (const detail::InstructionSet set : detail::available_instruction_sets()) {
      const double gap = detail::kernels<detail::GjkFilter>(set).box_gap(numbers(a), numbers(b));
      ASSERT_EQ(gap <= 0, overlap(a, b)) << detail::name_of(set);
    }
  }
  EXPECT_GT(overlapping, pairs / 5);
  EXPECT_LT(overlapping, pairs * 4 / 5);
}

TEST(Overlap, IsNeverDeniedWhenVerticesAreShared) {
  Random random(6);
  for (int i = 0; i < draws(3000); ++i) {
    Points a = random_points(random), b = random_points(random);
    const Vector3d offset = a[0] - b[0];
    for (Vector3d& point : b)
      point += offset;
    b.push_back(a[0]);
    ASSERT_TRUE(overlap(bounding_sphere(a), bounding_sphere(b))) << i;
    ASSERT_TRUE(overlap(axis_aligned_box(a), axis_aligned_box(b))) << i;
    ASSERT_TRUE(overlap(oriented_box(a, {}, BoxMethod::vertices), oriented_box(b, {}, BoxMethod::vertices)))
        << i;
  }
}

}  // namespace
}  // namespace fringe::FRINGE_TEST_FILE
