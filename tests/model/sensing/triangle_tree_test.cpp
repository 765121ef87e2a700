#include <gtest/gtest.h>

#include "fringe/distance_sensor.hpp"
#include "fringe/pose.hpp"
#include "fringe/triangulation.hpp"
#include "geometry.hpp"

/// Checks that the tree's answers are bit-identical to those of a search over all triangles.
namespace fringe::FRINGE_TEST_FILE {
namespace {

using Eigen::Vector3d;
using test::Random;

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
}  // namespace fringe::FRINGE_TEST_FILE
