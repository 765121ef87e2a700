/// Tests the tables of a single face and a single box: the rules are exact for the basis, and more points do
/// not change the matrices.

#include <array>
#include <cmath>

#include <Eigen/Cholesky>

#include <gtest/gtest.h>

#include "bem/box_self_interaction.hpp"
#include "bem/face_self_interaction.hpp"
#include "bem/jacobi_basis.hpp"

namespace fringe::detail::FRINGE_TEST_FILE {
namespace {

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

}  // namespace
}  // namespace fringe::detail::FRINGE_TEST_FILE
