#include <algorithm>
#include <limits>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "collision/bounding_volume.hpp"
#include "collision/gjk_filter.hpp"
#include "fringe/bounding_volume.hpp"
#include "fringe/convex_shape.hpp"
#include "shape_pairs.hpp"
#include "simd/dispatch.hpp"

/// Compares the overlap tests of bounding volumes with the certified intersection test of the same shapes.
namespace fringe::FRINGE_TEST_FILE {
namespace {

using Eigen::AlignedBox3d;
using Eigen::Isometry3d;
using Eigen::Vector3d;
using test::draws;
using test::Random;

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

ConvexShape shape_of(const BoundingSphere& sphere) {
  return ConvexShape::ball(sphere.radius);
}

Isometry3d pose_of(const BoundingSphere& sphere) {
  return Isometry3d(Eigen::Translation3d(sphere.centre));
}

/// The answer of an overlap test of two volumes, and whether their shapes intersect.
struct Answer {
  bool said, truth;
};

template <class First>
bool intersecting(const First& a, const OrientedBox& b) {
  return intersect(shape_of(a), pose_of(a), shape_of(b), pose_of(b));
}

Answer of_sphere_and_aligned_box(Random& random) {
  const BoundingSphere sphere = any_sphere(random);
  const AlignedBox3d box = any_aligned_box(random);
  return {overlap(sphere, box), intersecting(sphere, oriented(box))};
}

Answer of_sphere_and_oriented_box(Random& random) {
  const BoundingSphere sphere = any_sphere(random);
  const OrientedBox box = any_box(random);
  return {overlap(sphere, box), intersecting(sphere, box)};
}

Answer of_aligned_and_oriented_box(Random& random) {
  const AlignedBox3d a = any_aligned_box(random);
  const OrientedBox b = any_box(random);
  return {overlap(a, b), intersecting(oriented(a), b)};
}

detail::BoxNumbers numbers(const OrientedBox& from) {
  detail::BoxNumbers result{};
  std::copy(from.centre.begin(), from.centre.end(), result.centre);
  std::copy(from.axes.data(), from.axes.data() + from.axes.size(), result.axes);
  std::copy(from.half_widths.begin(), from.half_widths.end(), result.half_widths);
  return result;
}

/// Also checks that the answer is the same in the other order, with a margin and with every instruction set.
Answer of_oriented_boxes(Random& random) {
  const OrientedBox a = any_box(random), b = any_box(random);
  const bool said = overlap(a, b);
  EXPECT_EQ(overlap(b, a), said);
  EXPECT_EQ(detail::overlap_within(a, b, 1e-9), said);
  for (const detail::InstructionSet set : detail::available_instruction_sets())
    EXPECT_EQ(detail::kernels<detail::GjkFilter>(set).box_gap(numbers(a), numbers(b)) <= 0, said)
        << detail::name_of(set);
  return {said, intersecting(a, b)};
}

// Random pairs are never so close that rounding decides.
TEST(Overlap, AgreesWithTheIntersectionOfTheShapes) {
  constexpr int pairs = draws(20'000);
  const std::vector<std::pair<const char*, Answer (*)(Random&)>> kinds{
      {"sphere and aligned box", of_sphere_and_aligned_box},
      {"sphere and oriented box", of_sphere_and_oriented_box},
      {"aligned and oriented box", of_aligned_and_oriented_box},
      {"two oriented boxes", of_oriented_boxes}};
  for (const auto& [name, make] : kinds) {
    SCOPED_TRACE(name);
    Random random(1);
    int meeting = 0;
    for (int i = 0; i < pairs; ++i) {
      const auto [said, truth] = make(random);
      ASSERT_EQ(said, truth) << i;
      meeting += truth ? 1 : 0;
    }
    EXPECT_GT(meeting, pairs / 10) << "neither answer is rare";
    EXPECT_LT(meeting, pairs * 9 / 10);
  }
}

// The shapes touch or almost touch, some of them a kilometre away: a common vertex lies in the volumes around
// both.
TEST(Overlap, IsNeverDeniedWhenAVertexIsShared) {
  Random random(2);
  for (const test::PairClass& pair_class : test::pair_classes())
    for (int i = 0; i < draws(300); ++i) {
      SCOPED_TRACE(pair_class.name);
      test::ShapePair pair = pair_class.make(random);
      pair.b.push_back(pair.a.back());
      const BoundingSphere sphere_a = bounding_sphere(pair.a), sphere_b = bounding_sphere(pair.b);
      const AlignedBox3d aligned_a = axis_aligned_box(pair.a), aligned_b = axis_aligned_box(pair.b);
      const OrientedBox box_a = oriented_box(pair.a, {}, BoxMethod::vertices),
                        box_b = oriented_box(pair.b, {}, BoxMethod::vertices);
      ASSERT_TRUE(overlap(sphere_a, sphere_b));
      ASSERT_TRUE(overlap(aligned_a, aligned_b));
      ASSERT_TRUE(overlap(box_a, box_b));
      ASSERT_TRUE(overlap(sphere_a, aligned_b));
      ASSERT_TRUE(overlap(sphere_a, box_b));
      ASSERT_TRUE(overlap(aligned_a, box_b));
    }
}

TEST(Overlap, IsTrueForTouchingVolumes) {
  const auto from_to = [](double low, double high) {
    return AlignedBox3d(Vector3d(low, 0, 0), Vector3d(high, 1, 1));
  };
  const AlignedBox3d unit = from_to(0, 1);
  EXPECT_TRUE(overlap(BoundingSphere{{0, 0, 0}, 1}, BoundingSphere{{3, 0, 0}, 2}));
  EXPECT_FALSE(overlap(BoundingSphere{{0, 0, 0}, 1}, BoundingSphere{{3.001, 0, 0}, 2}));
  EXPECT_TRUE(overlap(unit, from_to(1, 2)));
  EXPECT_FALSE(overlap(unit, from_to(1 + std::numeric_limits<double>::epsilon(), 2)));
  EXPECT_TRUE(overlap(BoundingSphere{{3, 0.5, 0.5}, 2}, unit));
  EXPECT_FALSE(overlap(BoundingSphere{{3.001, 0.5, 0.5}, 2}, unit));
  EXPECT_TRUE(overlap(BoundingSphere{{0.5, 0.5, 0.5}, 0}, unit));
  EXPECT_TRUE(overlap(from_to(1, 2), oriented(unit)));
  EXPECT_FALSE(overlap(from_to(1.001, 2), oriented(unit)));
  EXPECT_FALSE(overlap(AlignedBox3d(), oriented(unit)));
}

}  // namespace
}  // namespace fringe::FRINGE_TEST_FILE
