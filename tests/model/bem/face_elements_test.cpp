/// Tests the tables of a single face and a single box: the rules are exact for the basis, and more points do
/// not change the matrices. Tests the interaction of two separate faces against sums over many points, from
/// far to nearly touching.

#include <algorithm>
#include <array>
#include <cmath>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "bem/box_self_interaction.hpp"
#include "bem/face_self_interaction.hpp"
#include "bem/jacobi_basis.hpp"
#include "bem/patch_distance.hpp"
#include "bem/single_layer_faces.hpp"
#include "geometry.hpp"

namespace fringe::detail::FRINGE_TEST_FILE {
namespace {

using Eigen::Vector3d;

constexpr std::array<EdgeKind, 2> edge_kinds{EdgeKind::thin, EdgeKind::right_angle};

TEST(JacobiBasis, IsOrthonormalUnderItsWeight) {
  for (const EdgeKind edge : edge_kinds) {
    const DirectionRule& rule = whole_rule(edge, 40);
    const WeightedPolynomials& polynomials = weighted_polynomials(edge);
    Eigen::MatrixXd values(most_functions, rule.nodes.size());
    for (Eigen::Index i = 0; i < rule.nodes.size(); ++i)
      polynomials.evaluate(rule.nodes[i], most_functions, values.col(i).data());
    const Eigen::MatrixXd products = rule.weights.topRows(most_functions) * values.transpose();
    const auto identity = Eigen::MatrixXd::Identity(most_functions, most_functions);
    EXPECT_LT((products - identity).cwiseAbs().maxCoeff(), 1e-12);
  }
}

TEST(JacobiBasis, HasANetChargeOnlyInItsFirstFunction) {
  for (const EdgeKind edge : edge_kinds) {
    const Eigen::VectorXd net = whole_rule(edge, 20).weights.rowwise().sum();
    EXPECT_NEAR(net[0], weighted_polynomials(edge).net_charge(), 1e-13);
    EXPECT_LT(net.tail(net.size() - 1).norm(), 1e-12);
  }
}

TEST(JacobiBasis, IsIntegratedByPanelsAsByTheWholeRule) {
  constexpr int functions = 6, points = 30;
  for (const EdgeKind edge : edge_kinds) {
    DirectionRule panels{Eigen::VectorXd(3 * points), Eigen::MatrixXd(functions, 3 * points)};
    add_panel(panels, 0, edge, functions, -1, -0.3, points);
    add_panel(panels, points, edge, functions, -0.3, 0.55, points);
    add_panel(panels, Eigen::Index{2} * points, edge, functions, 0.55, 1, points);
    const DirectionRule& whole = whole_rule(edge, points);
    const Eigen::VectorXd by_panels = panels.weights * (2 + panels.nodes.array()).inverse().matrix();
    const Eigen::VectorXd at_once =
        whole.weights.topRows(functions) * (2 + whole.nodes.array()).inverse().matrix();
    EXPECT_LT((by_panels - at_once).norm(), 1e-13);
  }
}

TEST(FaceSelfInteraction, DoesNotChangeWithMoreQuadraturePoints) {
  for (const int functions : {5, 9, 31})
    for (const EdgeKind edge : edge_kinds)
      for (const double aspect : {1.0, 0.05, 40.0}) {
        const auto matrix = [&](double more_points) {
          return parallel_faces(DistanceRule(edge, functions, more_points), {functions, functions},
                                {functions, functions}, 1, aspect, 0);
        };
        const Eigen::MatrixXd usual = matrix(1), finer = matrix(1.5);
        EXPECT_LT((usual - finer).cwiseAbs().maxCoeff(), 5e-10 * finer.cwiseAbs().maxCoeff()) << aspect;
      }
}

TEST(FaceSelfInteraction, TurnsWithTheFace) {
  const DistanceRule& rule = distance_rule(EdgeKind::thin, 5);
  const Eigen::MatrixXd upright = parallel_faces(rule, {4, 5}, {4, 5}, 1, 3, 0);
  const Eigen::MatrixXd lying = parallel_faces(rule, {5, 4}, {5, 4}, 3, 1, 0);
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 5; ++j)
      for (int k = 0; k < 4; ++k)
        for (int l = 0; l < 5; ++l)
          EXPECT_NEAR(upright(i * 5 + j, k * 5 + l), lying(j * 4 + i, l * 4 + k), 1e-12);
}

TEST(BoxSelfInteraction, OfOppositeFacesFarApartIsThatOfTwoPointCharges) {
  const double net = weighted_polynomials(EdgeKind::right_angle).net_charge();
  const Eigen::MatrixXd far =
      parallel_faces(distance_rule(EdgeKind::right_angle, 1), {1, 1}, {1, 1}, 1, 1, 1e6);
  EXPECT_NEAR(far(0, 0), std::pow(net, 4) / 1e6, 1e-15);
}

TEST(BoxSelfInteraction, IsPositiveDefiniteForFlatAndLongBoxes) {
  const std::array<FaceFunctions, box_faces> functions{{{5, 3}, {5, 3}, {3, 7}, {5, 5}, {7, 5}, {3, 3}}};
  for (const Eigen::Vector3d& half_sides :
       {Eigen::Vector3d(1, 1, 1), Eigen::Vector3d(1, 0.5, 0.01), Eigen::Vector3d(0.02, 0.03, 1)}) {
    const Eigen::MatrixXd matrix = box_self_interaction(half_sides, functions);
    EXPECT_EQ((matrix - matrix.transpose()).norm(), 0);
    EXPECT_EQ(Eigen::LLT<Eigen::MatrixXd>(matrix).info(), Eigen::Success);
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
    for (int i = 0; i <= steps; ++i) {
      const Vector3d place = a0 + (a1 - a0) * i / steps, edge = b1 - b0;
      const double share = std::clamp((place - b0).dot(edge) / edge.squaredNorm(), 0.0, 1.0);
      least = std::min(least, (place - b0 - share * edge).norm());
    }
    const double distance = segment_distance(a0, a1, b0, b1);
    EXPECT_LE(distance, least + 1e-12);
    EXPECT_GE(distance, least - 0.01);
  }
}

TEST(SegmentDistance, OfParallelAndOfPointlikeSegments) {
  EXPECT_DOUBLE_EQ(segment_distance({0, 0, 0}, {1, 0, 0}, {0.5, 2, 0}, {3, 2, 0}), 2);
  EXPECT_DOUBLE_EQ(segment_distance({0, 0, 0}, {1, 0, 0}, {4, 4, 0}, {3, 4, 0}), std::hypot(2, 4));
  EXPECT_DOUBLE_EQ(segment_distance({0, 0, 0}, {0, 0, 0}, {0, 3, 4}, {0, 3, 4}), 5);
}

}  // namespace
}  // namespace fringe::detail::FRINGE_TEST_FILE
