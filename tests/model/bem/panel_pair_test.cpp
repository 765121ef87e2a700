#include "bem/jacobi_basis.hpp"
#include "bem/panel_pair.hpp"
#include "bem/single_layer_faces.hpp"

#include <array>
#include <cmath>
#include <vector>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "bem/panel_quadrature.hpp"
#include "bem/patch_distance.hpp"
#include "geometry.hpp"
#include "surface/panel.hpp"

/// Interactions ∫∫1/r of two triangles with unit charges, against closed forms and what must not matter.
/// Tests the interaction of two separate faces against sums over many points, from far to nearly touching.
namespace fringe::detail::FRINGE_TEST_FILE {
namespace {

using Eigen::Vector3d;

double interaction(const Triangle& a, const Triangle& b, double tolerance = 1e-8) {
  PotentialSums sums;
  double sum = 0;
  add_pair(make_panel(a), make_panel(b), tolerance, sums, sum);
  sums.flush();
  return sum;
}

double self(const Triangle& triangle) {
  return panel_self(make_panel(triangle));
}

Triangle moved(const Triangle& triangle, const Eigen::Isometry3d& pose, double factor = 1) {
  return {factor * (pose * triangle[0]), factor * (pose * triangle[1]), factor * (pose * triangle[2])};
}

// The mean of 1/r between two points of the unit square is 4·ln(1 + √2) + 4/3·(1 − √2).
TEST(PanelPair, TwoHalvesOfASquareMakeUpTheSquare) {
  const double root = std::sqrt(2.0), mean = 4 * std::log(1 + root) + 4.0 / 3 * (1 - root);
  const std::vector<Triangle> halves = test::parallelogram({0, 0, 0}, {1, 0, 0}, {0, 1, 0});
  const double sum = self(halves[0]) + self(halves[1]) + 2 * interaction(halves[0], halves[1]);
  EXPECT_NEAR(sum / 4, mean, 1e-7);
}

// A panel interacts with itself as its quarters do with each other, of charges ¼.
TEST(PanelPair, APanelsOwnInteractionIsThatOfItsQuarters) {
  test::Random random(1);
  for (int i = 0; i < 10; ++i) {
    const Triangle triangle = random.triangle_in_box({-1, -1, -1}, {1, 1, 1});
    const std::array<Triangle, 4> parts = quarters(triangle);
    double sum = 0;
    for (const Triangle& a : parts)
      for (const Triangle& b : parts)
        sum += &a == &b ? self(a) : interaction(a, b);
    EXPECT_NEAR(sum / 16, self(triangle), 1e-6 * self(triangle));
  }
}

TEST(PanelPair, IsSymmetricAndDoesNotDependOnWhereBothAre) {
  test::Random random(2);
  for (int i = 0; i < 50; ++i) {
    const Triangle a = random.triangle_in_box({-1, -1, -1}, {1, 1, 1}),
                   b = random.triangle_in_box({-1, -1, -1}, {1, 1, 1});
    const Eigen::Isometry3d pose = random.rigid_motion();
    const double found = interaction(a, b, 1e-6);
    EXPECT_NEAR(interaction(b, a, 1e-6), found, 1e-5 * found);
    EXPECT_NEAR(interaction(moved(a, pose), moved(b, pose), 1e-6), found, 1e-5 * found);
    EXPECT_NEAR(interaction(moved(a, pose, 1e-3), moved(b, pose, 1e-3), 1e-6), 1e3 * found, 1e-2 * found);
    // Two halves of a have half of its charge each.
    const std::array<Triangle, 2> parts = halves(a, longest_side(a));
    EXPECT_NEAR((interaction(parts[0], b, 1e-6) + interaction(parts[1], b, 1e-6)) / 2, found, 1e-5 * found);
    EXPECT_LT(found, std::sqrt(self(a) * self(b)));
  }
}

TEST(PanelPair, OfDistantPanelsIsThatOfPointCharges) {
  test::Random random(3);
  for (int i = 0; i < 20; ++i) {
    const Triangle a = random.triangle_in_box({-1, -1, -1}, {1, 1, 1});
    const Eigen::Isometry3d away(Eigen::Translation3d(1000, 200, -300));
    const Triangle b = moved(random.triangle_in_box({-1, -1, -1}, {1, 1, 1}), away);
    const double distance = (make_panel(a).centre - make_panel(b).centre).norm();
    EXPECT_NEAR(interaction(a, b) * distance, 1, 2e-6);
  }
}

/// The mean of a potential over a triangle by a rule that is told how far its singularity is.
TEST(PanelQuadrature, GivesTheMeanOfThePotentialOfACharge) {
  test::Random random(4);
  for (int i = 0; i < 30; ++i) {
    const Triangle triangle = random.triangle_in_box({-1, -1, 0}, {1, 1, 0.2});
    const Vector3d charge = random.in_box({-1, -1, 0.3}, {1, 1, 1});
    const auto distance = [&](const Vector3d& point) { return (point - charge).norm(); };
    const auto mean_of = [&](const Triangle& part, double tolerance) {
      double weights = 0, sum = 0;
      for_each_point(part, tolerance, distance, [&](const Vector3d& point, double weight) {
        weights += weight;
        sum += weight / distance(point);
      });
      EXPECT_NEAR(weights, 1, 1e-12);
      return sum;
    };
    // Of quarters of quarters of quarters.
    std::vector<Triangle> parts{triangle};
    for (int k = 0; k < 3; ++k) {
      std::vector<Triangle> finer;
      for (const Triangle& part : parts)
        for (const Triangle& quarter : quarters(part))
          finer.push_back(quarter);
      parts = finer;
    }
    double expected = 0;
    for (const Triangle& part : parts)
      expected += mean_of(part, 1e-9) / static_cast<double>(parts.size());
    for (const double tolerance : {1e-2, 1e-4, 1e-6})
      EXPECT_NEAR(mean_of(triangle, tolerance), expected, tolerance * expected);
  }
  // Tighter tolerances and lower degrees need greater distances.
  EXPECT_LT(far_ratio(1e-6, 4), far_ratio(1e-3, 4));
  EXPECT_LT(far_ratio(1e-6, 2), far_ratio(1e-6, 4));
}

TEST(PanelQuadrature, AlongASegmentGivesItsLogarithm) {
  const Vector3d from(-1, 0.1, 0), to(1, 0.1, 0);
  const auto distance = [](const Vector3d& a, const Vector3d& b) {
    return segment_distance(Vector3d::Zero(), a, b);
  };
  for (const double tolerance : {1e-4, 1e-6, 1e-8}) {
    double weights = 0, sum = 0;
    for_each_point(from, to, tolerance, distance, [&](const Vector3d& point, double weight) {
      weights += weight;
      sum += weight / point.norm();
    });
    EXPECT_NEAR(weights, 1, 1e-12);
    // Parts of little weight may be less exact.
    EXPECT_NEAR(sum, std::asinh(10.0), 100 * tolerance);
  }
}

ChargedFace face(const Vector3d& centre, const Eigen::Quaterniond& turn, double half_u, double half_v,
                 EdgeKind edge = EdgeKind::thin) {
  return {centre, turn * Vector3d::UnitX(), turn * Vector3d::UnitY(), half_u, half_v, edge};
}

Eigen::Quaterniond turn(double degrees, const Vector3d& axis) {
  return Eigen::Quaterniond(Eigen::AngleAxisd(degrees * EIGEN_PI / 180, axis.normalized()));
}

/// Computes the same block by Gauss–Jacobi rules on both faces, with as many points as the distance requires.
Eigen::MatrixXd by_product_rule(const ChargedFace& a, FaceFunctions in_a, const ChargedFace& b,
                                FaceFunctions in_b, int points) {
  const DirectionRule& rule_a = whole_rule(a.edge, points);
  const DirectionRule& rule_b = whole_rule(b.edge, points - 1);
  const Eigen::Index n = rule_a.nodes.size(), m = rule_b.nodes.size();
  Eigen::MatrixXd kernel(n * n, m * m), weights_a(in_a.count(), n * n), weights_b(in_b.count(), m * m);
  for (Eigen::Index p = 0; p < n * n; ++p) {
    const Vector3d from =
        a.centre + rule_a.nodes[p / n] * a.half_u * a.axis_u + rule_a.nodes[p % n] * a.half_v * a.axis_v;
    for (Eigen::Index q = 0; q < m * m; ++q)
      kernel(p, q) = 1 / (b.centre + rule_b.nodes[q / m] * b.half_u * b.axis_u +
                          rule_b.nodes[q % m] * b.half_v * b.axis_v - from)
                             .norm();
    for (int k = 0; k < in_a.count(); ++k)
      weights_a(k, p) = rule_a.weights(k / in_a.v, p / n) * rule_a.weights(k % in_a.v, p % n);
  }
  for (Eigen::Index q = 0; q < m * m; ++q)
    for (int k = 0; k < in_b.count(); ++k)
      weights_b(k, q) = rule_b.weights(k / in_b.v, q / m) * rule_b.weights(k % in_b.v, q % m);
  return weights_a * kernel * weights_b.transpose();
}

double difference(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
  return (a - b).cwiseAbs().maxCoeff() / b.cwiseAbs().maxCoeff();
}

TEST(SingleLayerBlockAtLength, EqualsAProductRuleWithManyPoints) {
  const ChargedFace below = face({0, 0, 0}, turn(0, {0, 0, 1}), 1, 0.7);
  for (const EdgeKind edge : {EdgeKind::thin, EdgeKind::right_angle})
    for (const double height : {0.6, 1.5, 6.0}) {
      const ChargedFace above = face({0.3, 0.4, height}, turn(20, {1, 2, 3}), 0.5, 0.9, edge);
      const Eigen::MatrixXd truth = by_product_rule(below, {4, 3}, above, {3, 5}, 44);
      for (const double tolerance : {1e-4, 1e-8})
        EXPECT_LT(difference(single_layer_block(below, {4, 3}, above, {3, 5}, tolerance), truth), tolerance)
            << height;
    }
}

TEST(SingleLayerBlock, IsTransposedWhenTheFacesAreExchanged) {
  const ChargedFace a = face({0, 0, 0}, turn(0, {0, 0, 1}), 1, 0.7);
  const ChargedFace b = face({0.1, 0.2, 0.05}, turn(2, {1, 0.3, 0}), 0.3, 1.4);
  EXPECT_LT(difference(single_layer_block(a, {4, 5}, b, {3, 4}, 1e-9),
                       single_layer_block(b, {3, 4}, a, {4, 5}, 1e-9).transpose()),
            1e-9);
}

/// Faces close to each other in places that a sampling of the face misses: flat, on edge, corner to the
/// middle.
TEST(SingleLayerBlock, KeepsItsToleranceCloseTogether) {
  const ChargedFace below = face({0, 0, 0}, turn(0, {0, 0, 1}), 1, 1);
  for (const double gap : {0.1, 0.02}) {
    const std::array<ChargedFace, 4> others{
        face({0.2, -0.1, gap}, turn(0, {0, 0, 1}), 1, 0.6),
        face({0.37, 0.11, 0.5 + gap}, turn(90, {1, 0, 0}), 0.3, 0.5),
        face({1 + gap + 0.4, 0, 0}, turn(0, {0, 0, 1}), 0.4, 2, EdgeKind::right_angle),
        face({-0.43, 0.2, 0.5 * std::sqrt(2.0) + gap}, turn(90, {1, 0, 0}) * turn(45, {0, 0, 1}), 0.5, 0.5)};
    for (std::size_t k = 0; k < others.size(); ++k) {
      const Eigen::MatrixXd fine = single_layer_block(below, {3, 3}, others[k], {3, 3}, 1e-8);
      EXPECT_LT(difference(single_layer_block(below, {3, 3}, others[k], {3, 3}, 1e-4), fine), 1e-4)
          << "face " << k << ", gap " << gap;
    }
  }
}

TEST(SegmentDistance, IsTheLeastOverManyPoints) {
  test::Random random(7);
  const auto point = [&] { return random.in_box({-1, -1, -1}, {1, 1, 1}); };
  for (int trial = 0; trial < test::draws(50); ++trial) {
    const Vector3d a0 = point(), a1 = point(), b0 = point(), b1 = point();
    double least = 10;
    constexpr int steps = 200;
    for (int i = 0; i <= steps; ++i)
      for (int j = 0; j <= steps; ++j)
        least = std::min(least, (a0 + (a1 - a0) * i / steps - b0 - (b1 - b0) * j / steps).norm());
    const double distance = segment_distance(a0, a1, b0, b1);
    EXPECT_LE(distance, least + 1e-12);
    EXPECT_GE(distance, least - 0.02);
  }
}

TEST(SegmentDistance, OfParallelAndOfPointlikeSegments) {
  EXPECT_DOUBLE_EQ(segment_distance({0, 0, 0}, {1, 0, 0}, {0.5, 2, 0}, {3, 2, 0}), 2);
  EXPECT_DOUBLE_EQ(segment_distance({0, 0, 0}, {1, 0, 0}, {4, 4, 0}, {3, 4, 0}), std::hypot(2, 4));
  EXPECT_DOUBLE_EQ(segment_distance({0, 0, 0}, {0, 0, 0}, {0, 3, 4}, {0, 3, 4}), 5);
}

}  // namespace
}  // namespace fringe::detail::FRINGE_TEST_FILE
