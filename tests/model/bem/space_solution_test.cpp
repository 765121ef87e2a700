/// Solutions without the targets and with them, in one space of charges.

#include "bem/space_solution.hpp"

#include <cstddef>
#include <vector>

#include <Eigen/Cholesky>
#include <gtest/gtest.h>

#include "bem/panel_operator.hpp"
#include "fringe/triangulation.hpp"

namespace fringe::detail::FRINGE_TEST_FILE {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

std::vector<Triangle> ball(double radius, const Vector3d& centre) {
  std::vector<Triangle> triangles = triangulate(Sphere{radius, 10});
  for (Triangle& triangle : triangles)
    for (Vector3d& corner : triangle)
      corner += centre;
  return triangles;
}

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
    mesh.add(0, ball(0.05, {0, 0, 0}));
    mesh.add(1, ball(0.005, {0, 0.1, 0.55}));
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

}  // namespace
}  // namespace fringe::detail::FRINGE_TEST_FILE
