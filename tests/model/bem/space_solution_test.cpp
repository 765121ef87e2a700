/// Solutions without the targets and with them, in one space of charges, what one density on each group of
/// panels can hold, and conductors at rest: two balls by image charges.

#include "bem/space_solution.hpp"

#include <array>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

#include <Eigen/Cholesky>
#include <gtest/gtest.h>

#include "bem/conductors_at_rest.hpp"
#include "bem/group_densities.hpp"
#include "bem/panel_operator.hpp"
#include "bem/single_layer_panels.hpp"
#include "fringe/triangulation.hpp"
#include "scenes.hpp"

namespace fringe::detail::FRINGE_TEST_FILE {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// A machine of one ball, and a target far away: it changes the machine's capacitance by 7e-4 of it.
class SpaceSolutions : public ::testing::Test {
 protected:
  SpaceSolutions() {
    const Index count = matrix.size();
    net = MatrixXd::Zero(count, 2);
    is_machine = VectorXd::Zero(count);
    VectorXd areas(count);
    std::vector<std::size_t> bodies;
    for (const Index g : panels.tree().groups()) {
      const PanelGroup& group = mesh.groups()[static_cast<std::size_t>(g)];
      for (std::size_t k = group.first; k < group.first + group.count; ++k) {
        const Index place = panels.tree().places()[k];
        areas[place] = mesh.panels()[k].area;
        net(place, static_cast<Index>(group.body)) = 1;
        is_machine[place] = group.body == 0 ? 1 : 0;
      }
      bodies.insert(bodies.end(), group.count, group.body);
    }
    coarse = coarse_space(matrix, areas, bodies, 8);
    whole = matrix.apply(MatrixXd::Identity(count, count));
  }

  static PanelMesh two_balls() {
    PanelMesh mesh;
    mesh.add(0, triangulate(Sphere{0.05, 10}));
    mesh.add(1, test::shifted(triangulate(Sphere{0.005, 10}), {0, 0.1, 0.55}));
    return mesh;
  }

  SpaceSolution background(double accuracy) const {
    MatrixXd of_machine = net;
    of_machine.col(1).setZero();
    const BorderedMatrix machine{{}, Eigen::MatrixXf(0, matrix.size()), matrix, is_machine};
    return solve_space(machine, TwoLevelPreconditioner(machine, coarse, 1e-6, 1), of_machine,
                       VectorXd::Constant(2, accuracy), MatrixXd::Zero(matrix.size(), 2));
  }

  SpaceSolution with_targets(const SpaceSolution& before, double accuracy) const {
    const BorderedMatrix bordered{{}, Eigen::MatrixXf(0, matrix.size()), matrix, {}};
    return solve_with_targets(bordered, TwoLevelPreconditioner(bordered, coarse, 1e-6, 1), net,
                              VectorXd::Constant(2, accuracy), MatrixXd::Zero(matrix.size(), 2), before,
                              is_machine);
  }

  const PanelMesh mesh = two_balls();
  const PanelOperator panels{mesh, 1e-4, nullptr, 1};
  const HierarchicalMatrix& matrix = panels.matrix();
  CoarseSpace coarse;
  MatrixXd net;
  VectorXd is_machine;
  MatrixXd whole;
};

TEST_F(SpaceSolutions, AreThoseOfTheWholeMatrix) {
  const SpaceSolution found = with_targets(background(1e-12), 1e-10);
  ASSERT_TRUE(found.positive_definite);
  const MatrixXd wanted = net.transpose() * whole.llt().solve(net);
  EXPECT_LT((found.matrix - wanted).cwiseAbs().maxCoeff(), 1e-8 * wanted.maxCoeff());
}

TEST_F(SpaceSolutions, KnowTheChangeAsWellAsTheyKnowTheValue) {
  const SpaceSolution before = background(1e-9), found = with_targets(before, 1e-4);
  MatrixXd machine = whole;
  for (Index k = 0; k < is_machine.size(); ++k)
    if (is_machine[k] == 0) {
      machine.row(k).setZero();
      machine.col(k).setZero();
      machine(k, k) = 1;
    }
  const VectorXd charges = machine.llt().solve(VectorXd(is_machine.cwiseProduct(net.col(0))));
  const VectorXd potentials =
      (VectorXd::Ones(is_machine.size()) - is_machine).asDiagonal() * (whole * charges);
  const double change = potentials.dot(whole.llt().solve(potentials));
  EXPECT_LT(change, 1e-3 * before.matrix(0, 0));
  EXPECT_NEAR(found.matrix(0, 0) - before.matrix(0, 0), change, 1e-3 * change);
  EXPECT_LT(std::abs(found.matrix(0, 0) - before.matrix(0, 0) - change),
            10 * found.iteration_error_of_change()(0, 0));
  EXPECT_LT(found.iteration_error_of_change()(0, 0), 1e-2 * change);
}

/// Returns a mesh of a ball of panels in groups of about four, and a box of quartered triangles.
PanelMesh ball_and_box() {
  PanelMesh mesh;
  mesh.add(0, triangulate(Sphere{0.02, 24}));
  mesh.add(1, test::shifted(triangulate(Cuboid{0.03, 0.02, 0.01}), {0, 0, 0.05}));
  return mesh;
}

/// Returns the panels' charges (rows) if one group (column) has unit charge.
MatrixXd charges_of_groups(const PanelMesh& mesh) {
  MatrixXd charges =
      MatrixXd::Zero(static_cast<Index>(mesh.panels().size()), static_cast<Index>(mesh.groups().size()));
  for (std::size_t g = 0; g < mesh.groups().size(); ++g) {
    const PanelGroup& group = mesh.groups()[g];
    double area = 0;
    for (std::size_t k = group.first; k < group.first + group.count; ++k)
      area += mesh.panels()[k].area;
    for (std::size_t k = group.first; k < group.first + group.count; ++k)
      charges(static_cast<Index>(k), static_cast<Index>(g)) = mesh.panels()[k].area / area;
  }
  return charges;
}

TEST(GroupDensities, SpreadAChargeEvenlyOverTheGroup) {
  const PanelMesh mesh = ball_and_box();
  const MatrixXd charges = charges_of_groups(mesh);
  const VectorXd shares = area_shares(mesh);
  EXPECT_LT((charges.rowwise().sum() - shares).cwiseAbs().maxCoeff(), 1e-15);
  const MatrixXd values = MatrixXd::Random(charges.rows(), 3);
  EXPECT_LT((group_means(mesh, shares, values) - charges.transpose() * values).norm(), 1e-13);
}

TEST(GroupDensities, InteractAsTheirPanelsDoTogether) {
  const PanelMesh mesh = ball_and_box();
  const MatrixXd panels = single_layer_matrix(mesh.panels(), 1e-3);
  const MatrixXd charges = charges_of_groups(mesh);
  const MatrixXd wanted = charges.transpose() * (panels.selfadjointView<Eigen::Upper>() * charges);
  const MatrixXd found = group_matrix(mesh, area_shares(mesh), panels);
  EXPECT_LT((found - wanted).triangularView<Eigen::Lower>().toDenseMatrix().norm(), 1e-13 * wanted.norm());
}

/// Returns the charges of two balls in free space over 4πε, in m: of the first one, at unit potential, and of
/// the second, grounded; by image charges (W. Thomson, 1853). They must not touch.
/// @param distance of the centres
std::array<double, 2> two_balls(double first_radius, double second_radius, double distance) {
  double charge = first_radius, offset = 0;
  std::array<double, 2> sums{charge, 0};
  for (int k = 0; k < 200; ++k) {
    const double from_second = distance - offset;
    const double in_second = -charge * second_radius / from_second;
    const double from_first = distance - second_radius * second_radius / from_second;
    charge = -in_second * first_radius / from_first;
    offset = first_radius * first_radius / from_first;
    sums[0] += charge;
    sums[1] += in_second;
  }
  return sums;
}

// Triangles lie between the balls of their corners and smaller ones, and charges grow with the bodies.
TEST(ConductorsAtRestTest, TwoBallsHaveTheChargesOfTheirImages) {
  constexpr int segments = 24;
  constexpr double first = 0.05, second = 0.03, distance = 0.1, rtol = 2e-2;
  Scene scene;
  scene.objects = {test::object("first", Sphere{first, segments}, test::at(0, 0, 0), Electrode{}),
                   test::object("second", Sphere{second, segments}, test::at(distance, 0, 0))};
  const ConductorsAtRest found(charged_bodies(scene), rtol, 4000);
  const MatrixXd& matrix = found.matrix();
  ASSERT_EQ(matrix.rows(), 2);
  const double inside = std::pow(std::cos(EIGEN_PI / segments), 2);
  const auto [own, other] = two_balls(first, second, distance);
  const auto [least_own, least_other] = two_balls(inside * first, inside * second, distance);
  EXPECT_LT(matrix(0, 0), own);
  EXPECT_GT(matrix(0, 0), (1 - rtol) * least_own);
  EXPECT_LT(-matrix(1, 0), -other);
  EXPECT_GT(-matrix(1, 0), -(1 - rtol) * least_other);
  EXPECT_LT(matrix(1, 1), two_balls(second, first, distance)[0]);
  EXPECT_NEAR(matrix(0, 1), matrix(1, 0), 1e-3 * std::abs(other));
  // The charges of the panels add up to the matrix.
  MatrixXd sums = MatrixXd::Zero(2, 2);
  for (const PanelGroup& group : found.mesh().groups())
    sums.row(static_cast<Index>(found.bodies().bodies[group.body].conductor)) +=
        found.charges()
            .middleRows(static_cast<Index>(group.first), static_cast<Index>(group.count))
            .colwise()
            .sum();
  EXPECT_LT((sums - matrix).norm(), 1e-2 * matrix.norm());
  EXPECT_LE(found.error(), rtol);
}

TEST(ConductorsAtRestTest, AFloatingBallHasTheCapacitanceOfTheRoundOne) {
  constexpr int segments = 24;
  constexpr double radius = 0.05, rtol = 2e-2;
  Scene scene;
  scene.objects = {test::object("ball", Sphere{radius, segments}, test::at(0, 0, 0))};
  ChargedBodies bodies = charged_bodies(scene);
  bodies.conductors.front().role = Role::floating;
  bodies.conductors.front().is_asked = true;
  const ConductorsAtRest found(std::move(bodies), rtol, 4000);
  ASSERT_EQ(found.matrix().rows(), 1);
  EXPECT_LT(found.matrix()(0, 0), radius);
  EXPECT_GT(found.matrix()(0, 0), (1 - rtol) * std::pow(std::cos(EIGEN_PI / segments), 2) * radius);
}

}  // namespace
}  // namespace fringe::detail::FRINGE_TEST_FILE
