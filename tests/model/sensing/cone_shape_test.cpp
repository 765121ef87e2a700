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
#include "sensing/cone_shape.hpp"

/// Tests the collision test of the cone with which whole objects are skipped.
namespace fringe::detail::FRINGE_TEST_FILE {
namespace {

using Eigen::AlignedBox3d;
using Eigen::Isometry3d;
using Eigen::Vector3d;
using test::Random;

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

TEST(ConeShape, NeverMissesABoxThatIsSeen) {
  Random random(1);
  int visible = 0;
  for (int i = 0; i < cases; ++i) {
    const Case one = any_case(random);
    if (!seen(one))
      continue;
    ++visible;
    ASSERT_FALSE(misses(one)) << i;
  }
  EXPECT_GT(visible, cases / 20);
}

/// Tests objects that are only just seen: the range ends at the box, or the box touches the cone's lateral
/// surface in a point.
TEST(ConeShape, NeverMissesWhatIsOnTheBoundary) {
  Random random(2);
  int checked = 0;
  for (int i = 0; i < cases; ++i) {
    Case one = any_case(random);
    const auto point = seen(one);
    if (!point || point->distance == 0)
      continue;
    ++checked;
    one.cone.range = point->distance;
    ASSERT_FALSE(misses(one)) << i;
    const Vector3d sight = (point->point - one.cone.apex).normalized();
    const double angle = std::acos(std::min(1.0, sight.dot(one.cone.direction.normalized())));
    if (angle > 1e-3) {
      one.cone.full_angle = std::min(2 * angle * (1 + 1e-14), std::numbers::pi);
      ASSERT_TRUE(!seen(one) || !misses(one)) << i;
    }
  }
  EXPECT_GT(checked, cases / 20);
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
  RecordProperty("unseen", unseen);
  RecordProperty("by_planes", by_planes);
  RecordProperty("by_either", by_either);
  EXPECT_GT(3 * (by_either - by_planes), unseen - by_planes);
}

}  // namespace
}  // namespace fringe::detail::FRINGE_TEST_FILE
