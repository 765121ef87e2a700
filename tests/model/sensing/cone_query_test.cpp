#include "sensing/cone_query.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <vector>

#include <gtest/gtest.h>

#include "fringe/distance_sensor.hpp"
#include "fringe/pose.hpp"
#include "fringe/triangulation.hpp"
#include "geometry.hpp"
#include "sensing/cone_line.hpp"
#include "sensing/nearest_on_triangle.hpp"
#include "sensing/triangle_tree.hpp"

/// Lines, triangles and many triangles in a cone: both of the thesis' methods against the definition.
/// Checks that the tree's answers are bit-identical to those of a search over all triangles.
namespace fringe::detail::FRINGE_TEST_FILE {
namespace {

using Eigen::Vector3d;
using test::Random;

/// The angle between two vectors.
double angle_between(const Vector3d& a, const Vector3d& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

PreciseVector precise(const Vector3d& vector) {
  return exact_difference(vector, Vector3d::Zero());
}

/// Expects that a method finds where a line crosses the surface of a cone, and what is inside.
template <class Method>
void expect_by_angles(const Vector3d& axis, double half_angle, const PreciseVector& to_foot,
                      const PreciseVector& along, double distance) {
  const Method method(precise_cone(axis, 2 * half_angle));
  const PreciseLine line{{distance, 0}, method.to_frame(to_foot), method.to_frame(along)};
  std::vector<double> positions;
  for (const DoubleDouble& position : method.crossings(line)) {
    const Vector3d point = rounded(method.from_frame(line.point(position)));
    EXPECT_NEAR(angle_between(point, axis), half_angle, 1e-12);
    positions.push_back(position.high);
  }
  std::sort(positions.begin(), positions.end());
  // Between crossings the line is inside or outside throughout.
  for (double u = -8.1; u < 8; u += 0.37) {
    const PreciseVector at = line.point({u, 0});
    const double angle = angle_between(rounded(method.from_frame(at)), axis);
    EXPECT_EQ(method.contains(at), angle < half_angle) << u;
  }
  for (std::size_t k = 0; k <= positions.size(); ++k) {
    const double from = k == 0 ? -1e3 : positions[k - 1], to = k == positions.size() ? 1e3 : positions[k];
    const bool inside = method.contains(line.point({(from + to) / 2, 0}));
    for (const double share : {0.01, 0.3, 0.99})
      EXPECT_EQ(method.contains(line.point({from + share * (to - from), 0})), inside);
  }
}

TEST(ConeQuery, LinesCrossTheSurfaceWhereTheAngleToTheAxisIsTheHalfAngle) {
  test::Random random(1);
  for (int i = 0; i < 100; ++i) {
    const Vector3d axis = random.in_box({-1, -1, -1}, {1, 1, 1});
    const double half_angle = random.uniform(0.05, std::numbers::pi / 2 - 0.01);
    const PreciseVector along = polar(precise(random.in_box({-1, -1, -1}, {1, 1, 1}))).direction;
    const PreciseVector any = precise(random.in_box({-1, -1, -1}, {1, 1, 1}));
    const PreciseVector to_foot = polar(any - dot(any, along) * along).direction;
    const double distance = random.uniform(0.1, 2);
    expect_by_angles<FieldOfView>(axis, half_angle, to_foot, along, distance);
    expect_by_angles<ConeEquation>(axis, half_angle, to_foot, along, distance);
  }
}

/// The nearest point of a fine grid on a triangle in a cone about an axis with its apex at the origin.
std::optional<double> nearest_of_grid(const Triangle& triangle, const Vector3d& axis, double half_angle) {
  std::optional<double> nearest;
  constexpr int steps = 60;
  for (int i = 0; i <= steps; ++i)
    for (int j = 0; i + j <= steps; ++j) {
      const Vector3d point = (i * triangle[0] + j * triangle[1] + (steps - i - j) * triangle[2]) / steps;
      if (angle_between(point, axis) < half_angle)
        nearest = std::min(nearest.value_or(1e9), point.norm());
    }
  return nearest;
}

TEST(ConeQuery, NoPointOfATriangleInTheConeIsNearerThanTheOneFound) {
  test::Random random(2);
  int seen = 0;
  for (int i = 0; i < 100; ++i) {
    const Triangle triangle = random.triangle_in_box({-1, -1, -1}, {1, 1, 1});
    const Vector3d axis = random.in_box({-1, -1, -1}, {1, 1, 1});
    const double half_angle = random.uniform(0.2, 1.5);
    const PreciseCone cone = precise_cone(axis, 2 * half_angle);
    const std::optional<NearestPoint> found =
                                          nearest_on_triangle(triangle, Vector3d::Zero(), FieldOfView(cone)),
                                      other =
                                          nearest_on_triangle(triangle, Vector3d::Zero(), ConeEquation(cone));
    const std::optional<double> grid = nearest_of_grid(triangle, axis, half_angle);
    ASSERT_EQ(found.has_value(), other.has_value());
    if (grid) {
      ASSERT_TRUE(found);
      EXPECT_LE(found->distance, *grid + 1e-12);
    }
    if (!found)
      continue;
    ++seen;
    EXPECT_NEAR(found->distance, other->distance, 1e-12);
    EXPECT_NEAR(found->point.norm(), found->distance, 1e-12);
    EXPECT_LE(angle_between(found->point, axis), half_angle + 1e-9);
    // The point lies on the triangle: its three areas make up the triangle's.
    double areas = 0;
    for (int k = 0; k < 3; ++k)
      areas += (triangle[static_cast<std::size_t>(k)] - found->point)
                   .cross(triangle[static_cast<std::size_t>((k + 1) % 3)] - found->point)
                   .norm();
    EXPECT_NEAR(areas, (triangle[1] - triangle[0]).cross(triangle[2] - triangle[0]).norm(), 1e-7);
  }
  EXPECT_GT(seen, 20);
}

TEST(ConeQuery, AnswersTheSameInAnyOrderAndByATree) {
  test::Random random(3);
  std::vector<Triangle> triangles;
  for (int i = 0; i < 50; ++i)
    triangles.push_back(random.triangle_in_box({0, -1, -1}, {2, 1, 1}));
  // Two that are equally near: the first one counts.
  triangles.push_back(triangles[7]);
  const SensingCone cone{Vector3d(-1, 0, 0), Vector3d(1, 0, 0), 1.2, 5};
  ConeQuery forwards(cone, ConeMethod::field_of_view), backwards = forwards, by_tree = forwards;
  for (std::size_t k = 0; k < triangles.size(); ++k)
    forwards.offer(triangles[k], 4, k);
  for (std::size_t k = triangles.size(); k-- > 0;)
    backwards.offer(triangles[k], 4, k);
  TriangleTree(triangles).search(by_tree, Eigen::Isometry3d::Identity(), 4);
  ASSERT_TRUE(forwards.best());
  for (const ConeQuery* query : {&backwards, &by_tree}) {
    ASSERT_TRUE(query->best());
    EXPECT_EQ(query->best()->point.distance, forwards.best()->point.distance);
    EXPECT_EQ(query->best()->point.triangle, forwards.best()->point.triangle);
    EXPECT_EQ(query->best()->surface, 4U);
    EXPECT_LE(query->reach(), cone.range);
  }
  // Points beyond the range do not count.
  ConeQuery near({cone.apex, cone.direction, cone.full_angle, forwards.best()->point.distance * 0.99},
                 ConeMethod::field_of_view);
  for (std::size_t k = 0; k < triangles.size(); ++k)
    near.offer(triangles[k], 0, k);
  EXPECT_FALSE(near.best());
}

std::vector<Triangle> cloud(Random& random, int count, double size) {
  std::vector<Triangle> triangles;
  for (int i = 0; i < count; ++i) {
    Triangle& triangle = triangles.emplace_back(random.triangle_in_box({-1, -1, -1}, {1, 1, 1}));
    const Vector3d place = random.in_box({-1, -1, -1}, {1, 1, 1});
    for (Vector3d& vertex : triangle)
      vertex = place + size * vertex;
  }
  return triangles;
}

SensingCone any_cone(Random& random) {
  return {random.in_box({-1, -1, -1}, {1, 1, 1}), random.in_box({-1, -1, -1}, {1, 1, 1}),
          random.uniform(0.05, 3.14), random.uniform(0.1, 2)};
}

void expect_same(const std::optional<VisiblePoint>& a, const std::optional<VisiblePoint>& b) {
  ASSERT_EQ(a.has_value(), b.has_value());
  if (!a)
    return;
  EXPECT_EQ(a->distance, b->distance);
  EXPECT_EQ(a->point, b->point);
  EXPECT_EQ(a->triangle, b->triangle);
}

/// Compares the two searches for random cones, and returns how many cones see the triangles.
int compare(const std::vector<Triangle>& triangles, Random& random, int cones,
            const Eigen::Isometry3d& pose) {
  const SensedSurface surface(triangles);
  std::vector<Triangle> posed;
  for (const Triangle& triangle : triangles)
    posed.push_back(transformed(triangle, pose));
  int seen = 0;
  for (int i = 0; i < cones; ++i) {
    SensingCone cone = any_cone(random);
    cone.apex += pose.translation();
    const auto method = i % 2 == 0 ? ConeMethod::field_of_view : ConeMethod::cone_equation;
    const auto answer = surface.closest(cone, method, pose);
    expect_same(answer, cone_closest(posed, cone, method));
    seen += answer ? 1 : 0;
  }
  return seen;
}

TEST(SensedSurface, AgreesWithALookAtEveryTriangle) {
  Random random(1);
  for (const int count : {1, 2, 3, 7, 100, 400})
    for (const double size : {0.0, 0.03, 0.5}) {
      const int seen = compare(cloud(random, count, size), random, 40, Eigen::Isometry3d::Identity());
      EXPECT_GE(seen, count >= 100 ? 20 : 0);
    }
}

TEST(SensedSurface, AgreesOnAClosedMeshWhoseTrianglesShareVertices) {
  Random random(2);
  EXPECT_GE(compare(triangulate(Sphere{1, 40}), random, 200, Eigen::Isometry3d::Identity()), 50);
}

TEST(SensedSurface, AgreesWhenPosed) {
  Random random(3);
  const std::vector<Triangle> triangles = cloud(random, 200, 0.1);
  int seen = 0;
  for (int i = 0; i < 30; ++i) {
    Eigen::Isometry3d pose = random.rigid_motion();
    if (i % 3 == 1)
      pose.translation() *= 1e6;
    // The matrix deviates from orthonormal as far as pose_from_matrix accepts.
    if (i % 3 == 2)
      pose = pose_from_matrix(pose.linear() * (1 + 4e-10), pose.translation());
    seen += compare(triangles, random, 10, pose);
  }
  EXPECT_GE(seen, 100);
}

TEST(SensedSurface, AgreesOnTheApexOfDistanceZero) {
  Random random(4);
  const std::vector<Triangle> triangles = triangulate(Sphere{1, 20});
  const SensedSurface surface(triangles);
  for (const Triangle& triangle : triangles) {
    SensingCone cone = any_cone(random);
    cone.apex = (triangle[0] + triangle[1]) / 2;
    const auto answer = surface.closest(cone);
    ASSERT_TRUE(answer);
    EXPECT_EQ(answer->distance, 0);
    expect_same(answer, cone_closest(triangles, cone));
  }
}

TEST(SensedSurface, MayBeEmpty) {
  EXPECT_FALSE(SensedSurface({}).closest({Vector3d::Zero(), {0, 0, 1}, 1, 1}));
}

}  // namespace
}  // namespace fringe::detail::FRINGE_TEST_FILE
