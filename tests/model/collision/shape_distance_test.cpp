#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "fringe/convex_shape.hpp"
#include "fringe/error.hpp"
#include "fringe/gjk.hpp"
#include "real.hpp"
#include "shape_pairs.hpp"

/// Tests distances of posed shapes against those of their vertices' hulls, which are computed exactly.
namespace fringe::FRINGE_TEST_FILE {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;
using namespace test;

constexpr double promised = 1e-12;

/// Returns a rotation that permutes the axes and a translation by multiples of 1/4, which move small dyadic
/// coordinates without rounding.
Isometry3d exact_pose(Random& random) {
  const auto coordinate = [&] { return static_cast<double>(below(random, 33)) / 4 - 4; };
  Isometry3d pose = Isometry3d::Identity();
  const auto axis = static_cast<Eigen::Index>(below(random, 3));
  pose.linear().setZero();
  for (Eigen::Index k = 0; k < 3; ++k)
    pose.linear()((k + axis) % 3, k) = 1;
  const double x = coordinate(), y = coordinate();
  pose.translation() = Vector3d(x, y, coordinate());
  return pose;
}

/// Rounds coordinates to multiples of 2^−20, so that sums with a translation are exact.
Points rounded(Points points) {
  for (Vector3d& point : points)
    for (double& coordinate : point)
      coordinate = std::round(coordinate * 0x1p20) * 0x1p-20;
  return points;
}

/// Computes the smallest (direction·b − direction·a)/|direction| over all vertices in their unrounded poses.
Real separation(const Vector3d& direction, const Points& a, const Isometry3d& pose_a, const Points& b,
                const Isometry3d& pose_b) {
  const RealVector along = direction.cast<Real>();
  const auto height = [&](const Vector3d& point, const Isometry3d& pose) {
    return Real(along.dot(pose.linear().cast<Real>() * point.cast<Real>() + pose.translation().cast<Real>()));
  };
  Real least = std::numeric_limits<double>::infinity();
  for (const Vector3d& on_b : b)
    for (const Vector3d& on_a : a)
      least = std::min(least, Real(height(on_b, pose_b) - height(on_a, pose_a)));
  return least / sqrt(Real(along.squaredNorm()));
}

/// A shape with the vertices that it is the hull of.
struct Polytope {
  Points vertices;
  ConvexShape shape;
};

Polytope any_polytope(Random& random, bool is_cuboid) {
  if (is_cuboid) {
    const Vector3d half_widths = rounded({random.in_box({0, 0, 0}, {1, 1, 1})}).front();
    return {corners_of_box(half_widths), ConvexShape::cuboid(2 * half_widths)};
  }
  const Points vertices = rounded(any_shape(random, 12));
  return {vertices, ConvexShape::hull(vertices)};
}

TEST(GjkDistance, OfPosedHullsAndCuboidsIsThatOfTheirMovedVertices) {
  Random random(1);
  int disjoint = 0, in_floating_point = 0;
  constexpr int pairs = 3000;
  for (int i = 0; i < pairs; ++i) {
    const Polytope a = any_polytope(random, i % 10 == 0), b = any_polytope(random, i % 20 == 0);
    const Isometry3d pose_a = exact_pose(random), pose_b = exact_pose(random);
    const double truth = gjk_distance(moved(a.vertices, pose_a), moved(b.vertices, pose_b)).distance;
    const GjkDistance found = gjk_distance(a.shape, pose_a, b.shape, pose_b);
    ASSERT_NEAR(found.distance, truth, promised * truth) << i;
    ASSERT_LE(found.lower_bound, truth) << i;
    ASSERT_LE(found.distance - found.lower_bound, promised * truth) << i;
    disjoint += truth > 0 ? 1 : 0;
    in_floating_point += found.exact ? 0 : 1;
  }
  EXPECT_GT(disjoint, pairs / 2);
  EXPECT_GT(in_floating_point, disjoint * 9 / 10);
}

TEST(GjkDistance, OfPosedHullsIsProvenByItsDirectionAndItsWitnesses) {
  Random random(3);
  int proven = 0;
  constexpr int pairs = draws(500);
  for (int i = 0; i < pairs; ++i) {
    const Points a = any_shape(random, 12), b = any_shape(random, 12);
    const Isometry3d pose_a = random.rigid_motion(), pose_b = random.rigid_motion();
    const GjkDistance found = gjk_distance(ConvexShape::hull(a), pose_a, ConvexShape::hull(b), pose_b);
    if (found.exact || found.distance == 0)
      continue;
    ++proven;
    ASSERT_GE(separation(found.direction, a, pose_a, b, pose_b), found.lower_bound) << i;
    const double tolerance = 1e-14 * (1 + pose_a.translation().norm() + pose_b.translation().norm());
    ASSERT_LE(gjk_distance(Points{found.witness_a}, moved(a, pose_a)).distance, tolerance) << i;
    ASSERT_LE(gjk_distance(Points{found.witness_b}, moved(b, pose_b)).distance, tolerance) << i;
    ASSERT_NEAR((found.witness_b - found.witness_a).norm(), found.distance, tolerance) << i;
  }
  EXPECT_GT(proven, pairs / 2);
}

/// Compares with closed forms for two balls, and for a ball beside a cylinder, above a cone's apex and above
/// its lateral surface.
TEST(GjkDistance, OfRoundShapesEqualsClosedForms) {
  Random random(5);
  const auto at = [](double x, double y, double z) { return Isometry3d(Eigen::Translation3d(x, y, z)); };
  for (int i = 0; i < 300; ++i) {
    const Isometry3d motion = random.rigid_motion();
    const double r = random.uniform(0.1, 1), gap = random.uniform(0.2, 2);
    const auto expect = [&](const ConvexShape& a, const ConvexShape& b, const Isometry3d& place) {
      const GjkDistance found = gjk_distance(a, motion, b, motion * place);
      // The position itself is rounded.
      EXPECT_NEAR(found.distance, gap, 4e-15 * (1 + motion.translation().norm()) + promised * gap) << i;
      EXPECT_LE(found.distance - found.lower_bound, 1e-11 * gap) << i;
    };
    const ConvexShape ball = ConvexShape::ball(r);
    expect(ConvexShape::ball(1), ball, at(0, 1 + r + gap, 0));
    expect(ConvexShape::cylinder(0.5, 2), ball, at(0.5 + r + gap, 0, 0.7));
    expect(ConvexShape::cylinder(0.5, 2), ball, at(0.1, 0.2, 1 + r + gap));
    expect(ConvexShape::cone(1, 2), ball, at(0, 0, 1 + r + gap));
    // The lateral surface of a cone whose height equals its radius is inclined by 45°.
    const double along = std::sqrt(0.5) * (r + gap);
    expect(ConvexShape::cone(1, 1), ball, at(0.5 + along, 0, along));
  }
}

/// Checks that the two bounds enclose the truth, up to the rounding of positions of this size, and are close
/// to each other.
void expect_enclosed(const GjkDistance& found, double truth, double size, int number) {
  const double rounding = 1e-14 * size, positive = std::max(truth, 0.0);
  EXPECT_LE(found.lower_bound, positive + rounding) << number;
  EXPECT_GE(found.distance, positive - rounding) << number;
  EXPECT_LE(found.distance - found.lower_bound, 1e-11 * size) << number;
}

/// Balls, capsules, stadiums and rounded cuboids are boxes with none to three sides, swept by a ball.
TEST(GjkDistance, OfSweptBoxesIsThatOfTheirInnerBoxesLessTheirRadii) {
  Random random(7);
  int apart = 0;
  for (int i = 0; i < 800; ++i) {
    const auto side = [&] { return random.uniform(0, 1) < 0.4 ? 0 : random.uniform(0.1, 2); };
    const Vector3d core_a{side(), side(), side()}, core_b{side(), side(), side()};
    const double radius_a = random.uniform(0.01, 0.5), radius_b = random.uniform(0.01, 0.5);
    const Isometry3d pose_a = random.rigid_motion(),
                     pose_b =
                         Eigen::Translation3d(random.in_box({-3, -3, -3}, {3, 3, 3})) * random.rigid_motion();
    const double between =
        gjk_distance(moved(corners_of_box(core_a / 2), pose_a), moved(corners_of_box(core_b / 2), pose_b))
            .distance;
    const GjkDistance found = gjk_distance(ConvexShape::rounded_cuboid(core_a, radius_a), pose_a,
                                           ConvexShape::rounded_cuboid(core_b, radius_b), pose_b);
    const double truth = between - radius_a - radius_b;
    expect_enclosed(found, truth, 5 + pose_a.translation().norm() + pose_b.translation().norm(), i);
    apart += truth > 0;
  }
  EXPECT_GT(apart, 200);
}

/// The ball's centre lies on the normal through a point of the ellipsoid, along the gradient of Σ(pᵢ/aᵢ)². So
/// this point is the nearest one, and the gap is known.
TEST(GjkDistance, OfAnEllipsoidAndABallBeforeAPointOfItIsTheGapBetweenThem) {
  Random random(8);
  for (int i = 0; i < 200; ++i) {
    const Vector3d semi_axes = random.in_box({0.05, 0.05, 0.05}, {1, 1, 1}),
                   unit = random.in_box({-1, -1, -1}, {1, 1, 1}).normalized();
    const Vector3d point = unit.cwiseProduct(semi_axes), normal = unit.cwiseQuotient(semi_axes).normalized();
    const double radius = random.uniform(0.1, 1), gap = random.uniform(0.05, 1);
    const Isometry3d motion = random.rigid_motion(),
                     place = motion * Eigen::Translation3d(point + (radius + gap) * normal);
    expect_enclosed(gjk_distance(ConvexShape::ellipsoid(semi_axes), motion, ConvexShape::ball(radius), place),
                    gap, 3 + motion.translation().norm(), i);
  }
}

/// The height of the lowest point of an ellipsoid is that of its centre less √Σ(aᵢnᵢ)².
TEST(GjkDistance, OfAnEllipsoidAndAPlateIsThatOfItsLowestPoint) {
  Random random(9);
  for (int i = 0; i < 200; ++i) {
    const Vector3d semi_axes = random.in_box({0.05, 0.05, 0.05}, {1, 1, 1});
    Isometry3d pose = random.rigid_motion();
    const double reach = semi_axes.cwiseProduct(pose.linear().row(2).transpose()).norm();
    const double gap = random.uniform(0.01, 1);
    pose.translation() = Vector3d(0, 0, reach + gap);
    const GjkDistance found = gjk_distance(ConvexShape::ellipsoid(semi_axes), pose,
                                           ConvexShape::cuboid({20, 20, 0}), Isometry3d::Identity());
    expect_enclosed(found, gap, 20, i);
  }
}

TEST(GjkDistance, IsZeroForShapesThatIntersect) {
  const ConvexShape cone = ConvexShape::cone(1, 2), cuboid = ConvexShape::cuboid({1, 1, 1});
  Isometry3d beside = Isometry3d::Identity();
  beside.translation().x() = 0.9;
  for (const auto* shape : {&cone, &cuboid}) {
    const GjkDistance found = gjk_distance(*shape, beside, cuboid, Isometry3d::Identity());
    EXPECT_EQ(found.distance, 0);
    EXPECT_EQ(found.lower_bound, 0);
    EXPECT_LT((found.witness_a - found.witness_b).norm(), 1e-14);
  }
  beside.translation().x() = 1;
  EXPECT_EQ(gjk_distance(cuboid, beside, cuboid, Isometry3d::Identity()).distance, 0);
}

TEST(GjkDistance, IsAccurateForHugeAndTinyShapes) {
  const Isometry3d here = Isometry3d::Identity();
  for (const double unit : {0x1p-600, 0x1p-160, 0x1p160, 0x1p600}) {
    Isometry3d there = here;
    there.translation().x() = 3 * unit;
    const ConvexShape cuboid = ConvexShape::cuboid(Vector3d::Constant(unit));
    EXPECT_NEAR(gjk_distance(cuboid, here, cuboid, there).distance / unit, 2, 2e-12);
  }
  EXPECT_THROW(gjk_distance(ConvexShape::ball(0x1p300), here, ConvexShape::ball(1), here), InputError);
  Isometry3d nowhere = here;
  nowhere.translation().x() = NAN;
  EXPECT_THROW(gjk_distance(ConvexShape::ball(1), here, ConvexShape::ball(1), nowhere), InputError);
}

}  // namespace
}  // namespace fringe::FRINGE_TEST_FILE
