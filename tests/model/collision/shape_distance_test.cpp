#include <cmath>
#include <limits>

#include <boost/multiprecision/cpp_bin_float.hpp>
#include <gtest/gtest.h>

#include "fringe/convex_shape.hpp"
#include "fringe/error.hpp"
#include "fringe/gjk.hpp"
#include "shape_pairs.hpp"

/// Tests distances of posed shapes against those of their vertices' hulls, which are computed exactly.
namespace fringe::FRINGE_TEST_FILE {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;
using test::draws;
using test::Points;
using test::Random;
using Real = boost::multiprecision::cpp_bin_float_100;

constexpr double promised = 1e-12;

/// Returns a rotation that permutes the axes and a translation by multiples of 1/4, which move small dyadic
/// coordinates without rounding.
Isometry3d exact_pose(Random& random) {
  const auto coordinate = [&] { return static_cast<double>(test::below(random, 33)) / 4 - 4; };
  Isometry3d pose = Isometry3d::Identity();
  const auto axis = static_cast<Eigen::Index>(test::below(random, 3));
  pose.linear().setZero();
  for (Eigen::Index k = 0; k < 3; ++k)
    pose.linear()((k + axis) % 3, k) = 1;
  const double x = coordinate(), y = coordinate();
  pose.translation() = Vector3d(x, y, coordinate());
  return pose;
}

Points moved(const Points& points, const Isometry3d& pose) {
  Points result;
  for (const Vector3d& point : points)
    result.push_back(pose * point);
  return result;
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
  const auto along = [&](const Vector3d& point, const Isometry3d& pose) {
    Real sum = 0;
    for (Eigen::Index i = 0; i < 3; ++i) {
      Real coordinate = pose.translation()[i];
      for (Eigen::Index k = 0; k < 3; ++k)
        coordinate += Real(pose.linear()(i, k)) * point[k];
      sum += coordinate * direction[i];
    }
    return sum;
  };
  Real length = 0;
  for (const double component : direction)
    length += Real(component) * component;
  Real least = std::numeric_limits<double>::infinity();
  for (const Vector3d& on_b : b)
    for (const Vector3d& on_a : a)
      least = std::min<Real>(least, along(on_b, pose_b) - along(on_a, pose_a));
  return least / sqrt(length);
}

TEST(GjkDistance, OfPosedHullsIsThatOfTheirMovedVertices) {
  Random random(1);
  int disjoint = 0, in_floating_point = 0;
  constexpr int pairs = 3000;
  for (int i = 0; i < pairs; ++i) {
    const Points a = rounded(test::any_shape(random, 12)), b = rounded(test::any_shape(random, 12));
    const Isometry3d pose_a = exact_pose(random), pose_b = exact_pose(random);
    const double truth = gjk_distance(moved(a, pose_a), moved(b, pose_b)).distance;
    const GjkDistance found = gjk_distance(ConvexShape::hull(a), pose_a, ConvexShape::hull(b), pose_b);
    ASSERT_NEAR(found.distance, truth, promised * truth) << i;
    ASSERT_LE(found.lower_bound, truth) << i;
    ASSERT_LE(found.distance - found.lower_bound, promised * truth) << i;
    disjoint += truth > 0 ? 1 : 0;
    in_floating_point += found.exact ? 0 : 1;
  }
  EXPECT_GT(disjoint, pairs / 2);
  EXPECT_GT(in_floating_point, disjoint * 9 / 10);
}

/// Covers every class of the stress program, including gaps of 1e-15.
TEST(GjkDistance, OfClosePairsIsThatOfTheirVertices) {
  Random random(2);
  const Isometry3d here = Isometry3d::Identity();
  for (const test::PairClass& pair_class : test::pair_classes())
    for (int i = 0; i < 60; ++i) {
      const test::ShapePair pair = pair_class.make(random);
      const double truth = gjk_distance(pair.a, pair.b).distance;
      const GjkDistance found =
          gjk_distance(ConvexShape::hull(pair.a), here, ConvexShape::hull(pair.b), here);
      ASSERT_NEAR(found.distance, truth, promised * truth) << pair_class.name << ' ' << i;
      ASSERT_LE(found.lower_bound, truth) << pair_class.name << ' ' << i;
    }
}

TEST(GjkDistance, OfPosedHullsIsProvenByItsDirectionAndItsWitnesses) {
  Random random(3);
  int proven = 0;
  constexpr int pairs = draws(500);
  for (int i = 0; i < pairs; ++i) {
    const Points a = test::any_shape(random, 12), b = test::any_shape(random, 12);
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

TEST(GjkDistance, OfCuboidsIsThatOfTheirCorners) {
  Random random(4);
  for (int i = 0; i < 300; ++i) {
    const Vector3d half_a = rounded({random.in_box({0, 0, 0}, {1, 1, 1})}).front(),
                   half_b = rounded({random.in_box({0, 0, 0}, {1, 1, 1})}).front();
    const auto corners = [](const Vector3d& half) {
      Points points;
      for (const double x : {-1, 1})
        for (const double y : {-1, 1})
          for (const double z : {-1, 1})
            points.emplace_back(half.cwiseProduct(Vector3d(x, y, z)));
      return points;
    };
    const Isometry3d pose_a = exact_pose(random), pose_b = exact_pose(random);
    const double truth =
        gjk_distance(moved(corners(half_a), pose_a), moved(corners(half_b), pose_b)).distance;
    const GjkDistance found =
        gjk_distance(ConvexShape::cuboid(2 * half_a), pose_a, ConvexShape::cuboid(2 * half_b), pose_b);
    ASSERT_NEAR(found.distance, truth, promised * truth) << i;
  }
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

using RealVector = Eigen::Matrix<Real, 3, 1>;

/// Computes the squared distance of two segments: the least of where both derivatives vanish, if that is
/// within both, and of each end to the other segment.
Real squared_distance(const RealVector& a, const RealVector& to_b, const RealVector& c,
                      const RealVector& to_d) {
  const auto to_segment = [](const RealVector& point, const RealVector& start, const RealVector& along) {
    const Real share = (point - start).dot(along) / along.squaredNorm();
    const Real within = std::min<Real>(1, std::max<Real>(0, share));
    return Real((start + within * along - point).squaredNorm());
  };
  Real least = std::min({to_segment(a, c, to_d), to_segment(a + to_b, c, to_d), to_segment(c, a, to_b),
                         to_segment(c + to_d, a, to_b)});
  const RealVector offset = a - c;
  const Real bb = to_b.squaredNorm(), dd = to_d.squaredNorm(), bd = to_b.dot(to_d), ob = offset.dot(to_b),
             od = offset.dot(to_d), determinant = bb * dd - bd * bd;
  if (determinant > 0) {
    const Real s = (bd * od - dd * ob) / determinant, t = (bb * od - bd * ob) / determinant;
    if (s >= 0 && s <= 1 && t >= 0 && t <= 1)
      least = std::min<Real>(least, (offset + s * to_b - t * to_d).squaredNorm());
  }
  return least;
}

TEST(GjkDistance, OfCapsulesIsThatOfTheirSegmentsLessTheirRadii) {
  Random random(7);
  int apart = 0;
  for (int i = 0; i < 500; ++i) {
    const double length_a = random.uniform(0.1, 2), length_b = random.uniform(0.1, 2),
                 radius_a = random.uniform(0.01, 0.5), radius_b = random.uniform(0.01, 0.5);
    const Isometry3d pose_a = random.rigid_motion(),
                     pose_b = Isometry3d(Eigen::Translation3d(random.in_box({-2, -2, -2}, {2, 2, 2}))) *
                              random.rigid_motion();
    const auto start = [](const Isometry3d& pose, double length) {
      return RealVector((pose * Vector3d(0, 0, -length / 2)).cast<Real>());
    };
    const auto along = [](const Isometry3d& pose, double length) {
      return RealVector((pose.linear() * Vector3d(0, 0, length)).cast<Real>());
    };
    const Real between = sqrt(squared_distance(start(pose_a, length_a), along(pose_a, length_a),
                                               start(pose_b, length_b), along(pose_b, length_b)));
    const double truth = static_cast<double>(between - radius_a - radius_b);
    const GjkDistance found = gjk_distance(ConvexShape::rounded_cuboid({0, 0, length_a}, radius_a), pose_a,
                                           ConvexShape::rounded_cuboid({0, 0, length_b}, radius_b), pose_b);
    expect_enclosed(found, truth, 1 + pose_a.translation().norm() + pose_b.translation().norm(), i);
    apart += truth > 0;
  }
  EXPECT_GT(apart, 100);
}

/// Computes the distance of a point outside of an ellipsoid: the nearest point is aᵢ²pᵢ/(aᵢ² + t) with the
/// positive t for which it lies on the surface.
Real distance_to_ellipsoid(const Vector3d& semi_axes, const Vector3d& point) {
  const RealVector p = point.cast<Real>(), squares = semi_axes.cast<Real>().cwiseAbs2();
  const auto nearest = [&](const Real& t) {
    return RealVector(squares.cwiseProduct(p).cwiseQuotient(squares + RealVector::Constant(t)));
  };
  const auto is_outside = [&](const Real& t) {
    return nearest(t).cwiseAbs2().cwiseQuotient(squares).sum() > 1;
  };
  Real low = 0, high = 1;
  while (is_outside(high))
    high *= 2;
  for (int i = 0; i < 150; ++i) {
    const Real middle = (low + high) / 2;
    (is_outside(middle) ? low : high) = middle;
  }
  return (p - nearest(low)).norm();
}

TEST(GjkDistance, OfAnEllipsoidAndABallIsThatOfThePointLessTheRadius) {
  Random random(8);
  for (int i = 0; i < 200; ++i) {
    const Vector3d semi_axes = random.in_box({0.05, 0.05, 0.05}, {1, 1, 1}),
                   outwards = random.in_box({-1, -1, -1}, {1, 1, 1}).normalized();
    const Vector3d centre = random.uniform(1.2, 3) * outwards;
    const double from_centre = static_cast<double>(distance_to_ellipsoid(semi_axes, centre));
    const double radius = from_centre * random.uniform(0.1, 0.9);
    const Isometry3d motion = random.rigid_motion();
    const GjkDistance found = gjk_distance(ConvexShape::ellipsoid(semi_axes), motion,
                                           ConvexShape::ball(radius), motion * Eigen::Translation3d(centre));
    expect_enclosed(found, from_centre - radius, 3 + motion.translation().norm(), i);
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

TEST(GjkDistance, OfARoundedCuboidAndABallIsThatOfTheInnerBoxLessBothRadii) {
  Random random(10);
  for (int i = 0; i < 300; ++i) {
    Vector3d core = random.in_box({0, 0, 0}, {1, 1, 1});
    core[static_cast<Eigen::Index>(test::below(random, 3))] = 0;
    const double rounding = random.uniform(0.01, 0.3), radius = random.uniform(0.01, 0.3);
    const Vector3d centre = random.in_box({-3, -3, -3}, {3, 3, 3});
    const double truth = (centre.cwiseAbs() - core / 2).cwiseMax(0).matrix().norm() - rounding - radius;
    const Isometry3d motion = random.rigid_motion();
    const GjkDistance found = gjk_distance(ConvexShape::rounded_cuboid(core, rounding), motion,
                                           ConvexShape::ball(radius), motion * Eigen::Translation3d(centre));
    expect_enclosed(found, truth, 5 + motion.translation().norm(), i);
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

TEST(GjkDistance, IsZeroForManyVerticesAtATinyOffset) {
  Random random(6);
  Points points;
  for (int i = 0; i < 1300; ++i)
    points.push_back(random.in_box({-1, -1, -1}, {1, 1, 1}).normalized());
  const ConvexShape hull = ConvexShape::hull(points);
  const Isometry3d offset(Eigen::Translation3d(1e-310, 0, 0));
  EXPECT_EQ(gjk_distance(hull, offset, hull, Isometry3d::Identity()).distance, 0);
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
