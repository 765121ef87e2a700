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
#include "sensing/cone_bounds.hpp"
#include "sensing/cone_query.hpp"
#include "sensing/precise_cone.hpp"
#include "sensing/triangle_tree.hpp"

/// Lines, triangles and many triangles in a cone: both of the thesis' methods against the definition.
/// Checks that the tree's answers are bit-identical to those of a search over all triangles, and that what
/// the cone's shape skips is not seen.
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
  double nearest = cone.range;
  const FieldOfView view(precise_cone(cone.direction, cone.full_angle));
  for (const Triangle& triangle : triangles)
    if (const auto found = nearest_on_triangle(triangle, cone.apex, view))
      nearest = std::min(nearest, found->distance);
  EXPECT_EQ(forwards.best()->point.distance, nearest);
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
  // A closed mesh, whose triangles share vertices.
  EXPECT_GE(compare(triangulate(Sphere{1, 40}), random, 200, Eigen::Isometry3d::Identity()), 50);
  EXPECT_FALSE(SensedSurface({}).closest({Vector3d::Zero(), {0, 0, 1}, 1, 1}));
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

using Eigen::AlignedBox3d;
using Eigen::Isometry3d;

constexpr int cases = 20000;

struct Case {
  SensingCone cone;
  AlignedBox3d box;
  Isometry3d pose;
};

Case any_case(Random& random) {
  const Isometry3d pose = random.rigid_motion();
  const Vector3d low = random.in_box({-1, -1, -1}, {0.5, 0.5, 0.5});
  const AlignedBox3d box(low, low + random.in_box({0, 0, 0}, {1, 1, 1}));
  const SensingCone cone{pose * random.in_box({-2, -2, -2}, {2, 2, 2}),
                         random.in_box({-1, -1, -1}, {1, 1, 1}), random.uniform(0.05, std::numbers::pi),
                         random.uniform(0.1, 3)};
  return {cone, box, pose};
}

std::optional<VisiblePoint> seen(const Case& one) {
  std::vector<Triangle> triangles;
  const Vector3d sizes = one.box.sizes();
  const Isometry3d place = one.pose * Eigen::Translation3d(one.box.center());
  for (const Triangle& triangle : triangulate(Cuboid{sizes.x(), sizes.y(), sizes.z()}))
    triangles.push_back(transformed(triangle, place));
  return cone_closest(triangles, one.cone);
}

bool misses(const Case& one) {
  return ConeShape(one.cone, one.cone.range).misses(one.box, one.pose);
}

/// Also tests boxes that are only just seen: the range ends at the box, or the box touches the cone's lateral
/// surface in a point.
TEST(ConeShape, NeverMissesABoxThatIsSeen) {
  Random random(1);
  int visible = 0;
  for (int i = 0; i < cases; ++i) {
    Case one = any_case(random);
    const auto point = seen(one);
    if (!point)
      continue;
    ++visible;
    ASSERT_FALSE(misses(one)) << i;
    if (point->distance == 0)
      continue;
    one.cone.range = point->distance;
    ASSERT_FALSE(misses(one)) << i;
    const Vector3d sight = (point->point - one.cone.apex).normalized();
    const double angle = std::acos(std::min(1.0, sight.dot(one.cone.direction.normalized())));
    if (angle > 1e-3) {
      one.cone.full_angle = std::min(2 * angle * (1 + 1e-14), std::numbers::pi);
      ASSERT_TRUE(!seen(one) || !misses(one)) << i;
    }
  }
  EXPECT_GT(visible, cases / 20);
}

/// Checks that the cone shape skips at least a third of the unseen boxes that the planes and the distance do
/// not skip. The others lie beyond the spherical cap but within the flat end.
TEST(ConeShape, SparesMoreThanThePlanesDo) {
  Random random(3);
  int unseen = 0, by_planes = 0, by_either = 0;
  for (int i = 0; i < cases; ++i) {
    const Case one = any_case(random);
    if (seen(one))
      continue;
    ++unseen;
    const ConeBounds bounds(one.cone, one.pose);
    const bool planes = bounds.least_distance(one.box) > one.cone.range || bounds.misses(one.box);
    by_planes += planes ? 1 : 0;
    by_either += planes || misses(one) ? 1 : 0;
  }
  EXPECT_GT(3 * (by_either - by_planes), unseen - by_planes);
}

}  // namespace
}  // namespace fringe::detail::FRINGE_TEST_FILE
