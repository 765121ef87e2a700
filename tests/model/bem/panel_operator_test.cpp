/// Tests the hierarchical matrix of panels against all its elements, and the iterations that solve with it.

#include "bem/panel_operator.hpp"

#include <array>
#include <vector>

#include <gtest/gtest.h>

#include "bem/conjugate_gradients.hpp"
#include "bem/cross_approximation.hpp"
#include "bem/panel_system.hpp"
#include "bem/single_layer_panels.hpp"
#include "fringe/boundary_elements.hpp"
#include "fringe/triangulation.hpp"

namespace fringe::FRINGE_TEST_FILE {
namespace {

using detail::PanelMesh;
using detail::PanelOperator;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

std::vector<Triangle> moved(std::vector<Triangle> triangles, const Vector3d& by) {
  for (Triangle& triangle : triangles)
    for (Vector3d& corner : triangle)
      corner += by;
  return triangles;
}

/// Two balls of about 3,000 panels together, a millimetre apart.
PanelMesh two_balls() {
  PanelMesh mesh;
  mesh.add(0, triangulate(Sphere{0.05, 40}));
  mesh.add(1, moved(triangulate(Sphere{0.05, 40}), {0.101, 0, 0}));
  return mesh;
}

TEST(CrossApproximation, OfALowRankMatrixIsExact) {
  const MatrixXd left = MatrixXd::Random(30, 4), right = MatrixXd::Random(4, 50), matrix = left * right;
  const detail::LowRankFactors factors = detail::cross_approximation(
      {30, 50,
       [&](Index row, double* values) { Eigen::Map<VectorXd>(values, 50) = matrix.row(row).transpose(); },
       [&](Index column, double* values) { Eigen::Map<VectorXd>(values, 30) = matrix.col(column); }},
      1e-12);
  EXPECT_EQ(factors.rows.rows(), 4);
  EXPECT_LT((factors.rows.transpose() * factors.columns - matrix).norm(), 1e-12 * matrix.norm());
}

TEST(CrossApproximation, SeesAPartThatTheFirstCrossesMiss) {
  // Two blocks without common rows or columns: crosses of one know nothing of the other.
  MatrixXd matrix = MatrixXd::Zero(40, 40);
  matrix.topLeftCorner(20, 20).setConstant(2);
  matrix.bottomRightCorner(20, 20).setConstant(1);
  const detail::LowRankFactors factors = detail::cross_approximation(
      {40, 40,
       [&](Index row, double* values) { Eigen::Map<VectorXd>(values, 40) = matrix.row(row).transpose(); },
       [&](Index column, double* values) { Eigen::Map<VectorXd>(values, 40) = matrix.col(column); }},
      1e-6);
  EXPECT_LT((factors.rows.transpose() * factors.columns - matrix).norm(), 1e-6 * matrix.norm());
}

TEST(PanelOperators, MultiplyAsTheWholeMatrixDoes) {
  const PanelMesh mesh = two_balls();
  const MatrixXd whole = detail::single_layer_matrix(mesh.panels(), 1e-6).selfadjointView<Eigen::Upper>();
  const MatrixXd charges = MatrixXd::Random(whole.rows(), 3);
  for (const double tolerance : {1e-3, 1e-5}) {
    const PanelOperator panels(mesh, tolerance, nullptr, 1);
    const MatrixXd wanted = whole * charges.cwiseAbs();
    EXPECT_LT((panels.apply(charges.cwiseAbs()) - wanted).cwiseAbs().maxCoeff(),
              tolerance * wanted.maxCoeff());
    EXPECT_LT(panels.matrix().bytes(), 8U * static_cast<std::size_t>(whole.size()) / 2);
    EXPECT_FLOAT_EQ(static_cast<float>(panels.self(17)), static_cast<float>(whole(17, 17)));
  }
}

TEST(PanelOperators, HaveTheSameBitsForAnyNumberOfThreads) {
  const PanelMesh mesh = two_balls();
  const MatrixXd charges = MatrixXd::Random(static_cast<Index>(mesh.panels().size()), 2);
  const MatrixXd one = PanelOperator(mesh, 1e-4, nullptr, 1).apply(charges);
  for (const std::size_t threads : {2U, 3U})
    EXPECT_EQ(PanelOperator(mesh, 1e-4, nullptr, threads).apply(charges), one);
}

TEST(PanelOperators, KeepElementsOfPanelsThatStay) {
  PanelMesh mesh = two_balls();
  const PanelOperator before(mesh, 1e-4, nullptr, 1);
  std::vector<int> marked(mesh.groups().size(), 0);
  marked[5] = marked[60] = 1;
  mesh.refine(marked, MatrixXd::Ones(static_cast<Index>(mesh.panels().size()), 1));
  const MatrixXd charges = MatrixXd::Random(static_cast<Index>(mesh.panels().size()), 1);
  const MatrixXd anew = PanelOperator(mesh, 1e-4, nullptr, 1).apply(charges);
  EXPECT_LT((PanelOperator(mesh, 1e-4, &before, 1).apply(charges) - anew).norm(), 1e-4 * anew.norm());
}

TEST(PanelOperators, AreRestrictedAsTheWholeMatrixIs) {
  const PanelMesh mesh = two_balls();
  const PanelOperator panels(mesh, 1e-4, nullptr, 1);
  const Index size = panels.matrix().size(), few = 7;
  detail::Restriction restriction{std::vector<Index>(static_cast<std::size_t>(size)), VectorXd::Random(size)};
  MatrixXd functions = MatrixXd::Zero(size, few);
  for (Index k = 0; k < size; ++k) {
    restriction.target[static_cast<std::size_t>(k)] = k % few;
    functions(k, k % few) = restriction.weights[k];
  }
  const MatrixXd wanted = functions.transpose() * panels.matrix().apply(functions);
  EXPECT_LT((panels.matrix().dense_restricted(restriction, few) - wanted).norm(), 1e-12 * wanted.norm());
}

/// Solves for the charges on rows of boxes that are separated by a gap; returns the number of iterations.
int iterations(int boxes, double gap) {
  PanelMesh mesh;
  for (int k = 0; k < boxes; ++k)
    mesh.add(static_cast<std::size_t>(k), moved(triangulate(Cuboid{1, 1, 1}), Vector3d(1 + gap, 0, 0) * k),
             {1e-2, 2000});
  const PanelOperator panels(mesh, 1e-5, nullptr, 2);
  const detail::ClusterTree& tree = panels.tree();
  std::vector<std::size_t> bodies;
  VectorXd areas(panels.matrix().size());
  MatrixXd potentials = MatrixXd::Zero(areas.size(), boxes);
  for (const Index g : tree.groups()) {
    const detail::PanelGroup& group = mesh.groups()[static_cast<std::size_t>(g)];
    for (std::size_t k = group.first; k < group.first + group.count; ++k) {
      areas[static_cast<Index>(bodies.size())] = mesh.panels()[k].area;
      potentials(static_cast<Index>(bodies.size()), static_cast<Index>(group.body)) = 1;
      bodies.push_back(group.body);
    }
  }
  const detail::BorderedMatrix matrix{MatrixXd(0, 0), Eigen::MatrixXf(0, areas.size()), panels.matrix(),
                                      VectorXd()};
  // As many panels together as PanelSystem takes of up to 4,000.
  const detail::CoarseSpace coarse = detail::coarse_space(panels.matrix(), areas, bodies, 4);
  const detail::TwoLevelPreconditioner preconditioner(matrix, coarse, 1e-5, 2);
  EXPECT_TRUE(preconditioner.is_positive_definite());
  const detail::ConjugateGradientSolution solution =
      detail::conjugate_gradients(matrix, preconditioner, potentials, VectorXd::Constant(boxes, 1e-6),
                                  VectorXd::Zero(boxes), MatrixXd::Zero(areas.size(), boxes));
  EXPECT_TRUE(solution.positive_definite);
  const double residual = (potentials - matrix.apply(solution.charges)).norm();
  EXPECT_LT(residual, 0.05 * potentials.norm());
  return solution.iterations;
}

TEST(ConjugateGradients, NeedFewIterationsForNarrowGapsAndManyBodies) {
  EXPECT_LT(iterations(2, 1e-1), 40);
  EXPECT_LT(iterations(2, 1e-3), 40);
  EXPECT_LT(iterations(40, 1e-3), 40);
}

TEST(BoundaryElementThreads, DoNotChangeTheAnswer) {
  Scene scene;
  scene.sensors.push_back({"front", {}, 2.5, 5e-12, {{{-0.05, -0.05, 0}, {0.1, 0, 0}, {0, 0.1, 0}}}});
  Object ball{"ball",     {},  Sphere{0.03, 24}, Eigen::Isometry3d(Eigen::Translation3d(0, 0, 0.05)),
              Grounded{}, true};
  scene.objects.push_back(ball);
  const MaxwellMatrix one = maxwell(scene, {.rtol = 1e-2, .threads = 1});
  const MaxwellMatrix three = maxwell(scene, {.rtol = 1e-2, .threads = 3});
  EXPECT_EQ(one.values, three.values);
  EXPECT_EQ(one.errors, three.errors);
}

}  // namespace
}  // namespace fringe::FRINGE_TEST_FILE
