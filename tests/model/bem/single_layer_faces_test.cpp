/// Tests the interaction of two separate faces against sums over many points, from far to nearly touching.

#include "bem/single_layer_faces.hpp"

#include <array>
#include <cmath>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "bem/patch_distance.hpp"
#include "geometry.hpp"

namespace fringe::detail::FRINGE_TEST_FILE {
namespace {

using Eigen::Vector3d;

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
