#include <array>
#include <vector>

#include <gtest/gtest.h>

#include "fringe/bounding_volume.hpp"
#include "fringe/convex_shape.hpp"
#include "shape_pairs.hpp"

/// Compares the overlap tests of bounding volumes of two kinds with the certified intersection test of the
/// same shapes.
namespace fringe::FRINGE_TEST_FILE {
namespace {

using Eigen::AlignedBox3d;
using Eigen::Isometry3d;
using Eigen::Vector3d;
using test::draws;
using test::Random;

constexpr int pairs = draws(20000);

OrientedBox any_box(Random& random) {
  const Isometry3d motion = random.rigid_motion();
  return {random.in_box({-1, -1, -1}, {1, 1, 1}), motion.linear().transpose(),
          random.in_box({0, 0, 0}, {0.8, 0.8, 0.8})};
}

AlignedBox3d any_aligned_box(Random& random) {
  const Vector3d low = random.in_box({-1.5, -1.5, -1.5}, {1, 1, 1});
  return {low, low + random.in_box({0, 0, 0}, {1.2, 1.2, 1.2})};
}

BoundingSphere any_sphere(Random& random) {
  return {random.in_box({-1.5, -1.5, -1.5}, {1.5, 1.5, 1.5}), random.uniform(0, 1)};
}

Isometry3d pose_of(const OrientedBox& box) {
  Isometry3d pose = Isometry3d::Identity();
  pose.linear() = box.axes.transpose();
  pose.translation() = box.centre;
  return pose;
}

ConvexShape shape_of(const OrientedBox& box) {
  return ConvexShape::cuboid(2 * box.half_widths);
}

OrientedBox oriented(const AlignedBox3d& box) {
  return {box.center(), Eigen::Matrix3d::Identity(), box.sizes() / 2};
}

bool meets(const BoundingSphere& sphere, const OrientedBox& box) {
  Isometry3d place = Isometry3d::Identity();
  place.translation() = sphere.centre;
  return intersect(ConvexShape::ball(sphere.radius), place, shape_of(box), pose_of(box));
}

/// Checks that both tests agree on random pairs, and that neither answer is rare. Random pairs are never so
/// close that rounding decides.
template <class Make>
void expect_agreement(const Make& make) {
  Random random(1);
  int meeting = 0;
  for (int i = 0; i < pairs; ++i) {
    const auto [answer, truth] = make(random);
    ASSERT_EQ(answer, truth) << i;
    meeting += truth ? 1 : 0;
  }
  EXPECT_GT(meeting, pairs / 10);
  EXPECT_LT(meeting, pairs * 9 / 10);
}

TEST(MixedOverlap, OfSphereAndAlignedBoxAgreesWithGjk) {
  expect_agreement([](Random& random) {
    const BoundingSphere sphere = any_sphere(random);
    const AlignedBox3d box = any_aligned_box(random);
    return std::pair(overlap(sphere, box), meets(sphere, oriented(box)));
  });
}

TEST(MixedOverlap, OfSphereAndOrientedBoxAgreesWithGjk) {
  expect_agreement([](Random& random) {
    const BoundingSphere sphere = any_sphere(random);
    const OrientedBox box = any_box(random);
    return std::pair(overlap(sphere, box), meets(sphere, box));
  });
}

TEST(MixedOverlap, OfAlignedAndOrientedBoxAgreesWithGjk) {
  expect_agreement([](Random& random) {
    const AlignedBox3d a = any_aligned_box(random);
    const OrientedBox own = oriented(a), b = any_box(random);
    return std::pair(overlap(a, b), intersect(shape_of(own), pose_of(own), shape_of(b), pose_of(b)));
  });
}

/// Checks that the bounding volumes of shapes that touch or almost touch, some of them a kilometre away, are
/// never reported as disjoint.
TEST(MixedOverlap, IsNeverDeniedWhenAVertexIsShared) {
  Random random(2);
  for (const test::PairClass& pair_class : test::pair_classes())
    for (int i = 0; i < 100; ++i) {
      test::ShapePair pair = pair_class.make(random);
      // With one common vertex the volumes meet, whatever the class.
      pair.b.push_back(pair.a.back());
      const BoundingSphere sphere = bounding_sphere(pair.a);
      const AlignedBox3d aligned = axis_aligned_box(pair.b);
      const OrientedBox box = oriented_box(pair.b, {}, BoxMethod::vertices);
      ASSERT_TRUE(overlap(sphere, aligned)) << pair_class.name;
      ASSERT_TRUE(overlap(sphere, box)) << pair_class.name;
      ASSERT_TRUE(overlap(axis_aligned_box(pair.a), box)) << pair_class.name;
    }
}

TEST(MixedOverlap, IsTrueForTouchingVolumes) {
  const AlignedBox3d unit{Vector3d(0, 0, 0), Vector3d(1, 1, 1)};
  EXPECT_TRUE(overlap(BoundingSphere{{3, 0.5, 0.5}, 2}, unit));
  EXPECT_FALSE(overlap(BoundingSphere{{3.001, 0.5, 0.5}, 2}, unit));
  EXPECT_TRUE(overlap(BoundingSphere{{0.5, 0.5, 0.5}, 0}, unit));
  EXPECT_TRUE(overlap(AlignedBox3d{Vector3d(1, 1, 1), Vector3d(2, 2, 2)}, oriented(unit)));
  EXPECT_FALSE(overlap(AlignedBox3d{Vector3d(1.001, 1, 1), Vector3d(2, 2, 2)}, oriented(unit)));
  EXPECT_FALSE(overlap(AlignedBox3d(), oriented(unit)));
}

}  // namespace
}  // namespace fringe::FRINGE_TEST_FILE
