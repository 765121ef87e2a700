#include "bem/panel_operator.hpp"

#include <cmath>
#include <cstddef>
#include <limits>
#include <set>
#include <utility>
#include <vector>

#include <Eigen/Eigenvalues>
#include <gtest/gtest.h>

#include "bem/bordered_matrix.hpp"
#include "bem/cluster_tree.hpp"
#include "bem/cross_approximation.hpp"
#include "bem/hierarchical_matrix.hpp"
#include "bem/single_layer_panels.hpp"
#include "bem/space_solution.hpp"
#include "bem/two_level_preconditioner.hpp"
#include "fringe/triangulation.hpp"
#include "scenes.hpp"

/// The single-layer matrix of panels in blocks: its tree, its restrictions, its border and its
/// preconditioner, against all its elements, and the iterations that solve with it.
namespace fringe::detail::FRINGE_TEST_FILE {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

/// Returns a matrix of numbers without order, the same in every run.
MatrixXd numbers(Index rows, Index columns) {
  return MatrixXd::NullaryExpr(rows, columns, [](Index row, Index column) {
    return std::sin(1 + 37.0 * static_cast<double>(row * 7 + column));
  });
}

/// Returns the areas of the panels and the bodies to which they belong, in the order of a tree.
std::pair<VectorXd, std::vector<std::size_t>> areas_and_bodies(const PanelMesh& mesh,
                                                               const ClusterTree& tree) {
  VectorXd areas(static_cast<Index>(mesh.panels().size()));
  std::vector<std::size_t> bodies;
  for (const Index g : tree.groups()) {
    const PanelGroup& group = mesh.groups()[static_cast<std::size_t>(g)];
    for (std::size_t k = group.first; k < group.first + group.count; ++k) {
      areas[static_cast<Index>(bodies.size())] = mesh.panels()[k].area;
      bodies.push_back(group.body);
    }
  }
  return {areas, bodies};
}

/// A ball and a cube beside it.
class PanelMatrix : public testing::Test {
 protected:
  static PanelMesh make_mesh() {
    PanelMesh mesh;
    mesh.add(0, triangulate(Sphere{0.05, 10}));
    mesh.add(1, test::shifted(triangulate(Cuboid{0.05, 0.05, 0.05}), {0.15, 0, 0}));
    return mesh;
  }

  const PanelMesh mesh = make_mesh();
  const PanelOperator panels{mesh, 1e-6, nullptr, 1};
  const HierarchicalMatrix& matrix = panels.matrix();
  const MatrixXd whole = matrix.apply(MatrixXd::Identity(matrix.size(), matrix.size()));
};

TEST_F(PanelMatrix, ClustersHoldTheirPanelsAndEveryPairIsInOneBlock) {
  const ClusterTree tree(mesh);
  const auto count = mesh.panels().size();
  ASSERT_EQ(tree.panels().size(), count);
  for (std::size_t panel = 0; panel < count; ++panel)
    EXPECT_EQ(tree.panels()[static_cast<std::size_t>(tree.places()[panel])], static_cast<Index>(panel));
  for (const TreeCluster& cluster : tree.clusters()) {
    for (Index place = cluster.panels.first; place < cluster.panels.first + cluster.panels.count; ++place) {
      const Panel& panel =
          mesh.panels()[static_cast<std::size_t>(tree.panels()[static_cast<std::size_t>(place)])];
      for (const Vector3d& corner : panel.corners)
        EXPECT_LT(cluster.box.exteriorDistance(corner), 1e-12);
      EXPECT_LE(panel.radius, cluster.largest_radius);
    }
    if (!cluster.is_leaf()) {
      EXPECT_EQ(tree.clusters()[cluster.left].panels.count + tree.clusters()[cluster.left + 1].panels.count,
                cluster.panels.count);
    }
  }
  std::vector<int> times(count * count);
  const ClusterPairs pairs = cluster_pairs(tree, 1e-4);
  EXPECT_FALSE(pairs.far.empty());
  for (const std::vector<ClusterPair>* kind : {&pairs.far, &pairs.near})
    for (const auto& [a, b, degree] : *kind) {
      const ClusterRange rows = tree.clusters()[a].panels, columns = tree.clusters()[b].panels;
      for (Index row = rows.first; row < rows.first + rows.count; ++row)
        for (Index column = columns.first; column < columns.first + columns.count; ++column) {
          ++times[static_cast<std::size_t>(row) * count + static_cast<std::size_t>(column)];
          if (a != b)
            ++times[static_cast<std::size_t>(column) * count + static_cast<std::size_t>(row)];
        }
    }
  EXPECT_EQ(std::set<int>(times.begin(), times.end()), std::set<int>{1});
}

TEST(ClusterTrees, PartLargePanelsFromSmallOnesBesideThem) {
  PanelMesh beside;
  beside.add(0, triangulate(Cuboid{1, 1, 1}));
  beside.add(1, test::shifted(triangulate(Sphere{0.02, 16}), {0.55, 0, 0}));
  const ClusterTree tree(beside);
  for (const std::size_t leaf : tree.leaves()) {
    const ClusterRange groups = tree.clusters()[leaf].groups;
    std::set<std::size_t> bodies;
    for (Index place = groups.first; place < groups.first + groups.count; ++place)
      bodies.insert(
          beside.groups()[static_cast<std::size_t>(tree.groups()[static_cast<std::size_t>(place)])].body);
    EXPECT_EQ(bodies.size(), 1U);
  }
}

TEST_F(PanelMatrix, IsSymmetricAndPositiveDefinite) {
  EXPECT_LT((whole - whole.transpose()).norm(), 1e-12 * whole.norm());
  EXPECT_GT(Eigen::SelfAdjointEigenSolver<MatrixXd>(whole, Eigen::EigenvaluesOnly).eigenvalues().minCoeff(),
            0);
}

TEST_F(PanelMatrix, RestrictionsAreThoseOfAllElements) {
  // Every group of the tree becomes one unknown.
  const ClusterTree& tree = panels.tree();
  Restriction restriction{{}, numbers(matrix.size(), 1)};
  std::vector<ClusterRange> ranges;
  for (std::size_t place = 0; place < tree.groups().size(); ++place)
    restriction.target.insert(restriction.target.end(),
                              mesh.groups()[static_cast<std::size_t>(tree.groups()[place])].count,
                              static_cast<Index>(place));
  for (const TreeCluster& cluster : tree.clusters())
    ranges.push_back(cluster.groups);
  const auto groups = static_cast<Index>(tree.groups().size());
  MatrixXd combinations = MatrixXd::Zero(matrix.size(), groups);
  for (Index k = 0; k < matrix.size(); ++k)
    combinations(k, restriction.target[static_cast<std::size_t>(k)]) = restriction.weights[k];
  const MatrixXd expected = combinations.transpose() * whole * combinations;
  EXPECT_LT((matrix.dense_restricted(restriction, groups) - expected).norm(), 1e-12 * expected.norm());
  const HierarchicalMatrix restricted = matrix.restricted(restriction, ranges);
  EXPECT_LT((restricted.apply(MatrixXd::Identity(groups, groups)) - expected).norm(),
            std::numeric_limits<float>::epsilon() * expected.norm());
}

TEST_F(PanelMatrix, ABorderIsMultipliedAsThatOfAWholeMatrix) {
  const Index functions = 3, size = functions + matrix.size();
  MatrixXd all = MatrixXd::Zero(size, size);
  const MatrixXd corner = numbers(functions, functions);
  all.topLeftCorner(functions, functions) = corner + corner.transpose();
  const Eigen::MatrixXf coupling = numbers(functions, matrix.size()).cast<float>();
  all.topRightCorner(functions, matrix.size()) = coupling.cast<double>();
  all.bottomLeftCorner(matrix.size(), functions) = all.topRightCorner(functions, matrix.size()).transpose();
  all.bottomRightCorner(matrix.size(), matrix.size()) = whole;
  VectorXd present = VectorXd::Ones(size);
  const BorderedMatrix bordered{all.topLeftCorner(functions, functions), coupling, matrix, {}};
  const MatrixXd factors = numbers(size, 2);
  EXPECT_EQ(bordered.size(), size);
  EXPECT_LT((bordered.apply(factors) - all * factors).norm(), 1e-12 * (all * factors).norm());
  present[1] = present[7] = 0;
  const BorderedMatrix without{bordered.functions, bordered.coupling, matrix, present};
  const MatrixXd rows = present.asDiagonal() * (all * factors);
  EXPECT_LT((without.apply(factors) - rows).norm(), 1e-12 * rows.norm());
}

// Conjugate gradients need some √(condition) iterations: the preconditioned condition stays small.
TEST_F(PanelMatrix, ThePreconditionerIsSymmetricAndBringsTheEigenvaluesTogether) {
  const auto [areas, bodies] = areas_and_bodies(mesh, panels.tree());
  const CoarseSpace coarse = coarse_space(matrix, areas, bodies, 16);
  EXPECT_LT(coarse.matrix.rows(), matrix.size() / 8);
  const BorderedMatrix bordered{{}, Eigen::MatrixXf(0, matrix.size()), matrix, {}};
  const TwoLevelPreconditioner preconditioner(bordered, coarse, 1e-6, 1);
  ASSERT_TRUE(preconditioner.is_positive_definite());
  const MatrixXd applied = preconditioner.apply(MatrixXd::Identity(matrix.size(), matrix.size()));
  EXPECT_LT((applied - applied.transpose()).norm(), 1e-10 * applied.norm());
  // The eigenvalues of P·A are those of LᵀPL with A = LLᵀ.
  const MatrixXd lower = whole.llt().matrixL();
  const VectorXd values =
      Eigen::SelfAdjointEigenSolver<MatrixXd>(lower.transpose() * applied * lower, Eigen::EigenvaluesOnly)
          .eigenvalues();
  const VectorXd own = Eigen::SelfAdjointEigenSolver<MatrixXd>(whole, Eigen::EigenvaluesOnly).eigenvalues();
  EXPECT_GT(values.minCoeff(), 0);
  EXPECT_LT(values.maxCoeff() / values.minCoeff(), 50);
  EXPECT_LT(values.maxCoeff() / values.minCoeff(), own.maxCoeff() / own.minCoeff() / 4);
}

/// Two balls of about 2,000 panels together, a millimetre apart.
PanelMesh two_balls() {
  PanelMesh mesh;
  mesh.add(0, triangulate(Sphere{0.05, 32}));
  mesh.add(1, test::shifted(triangulate(Sphere{0.05, 32}), {0.101, 0, 0}));
  return mesh;
}

LowRankFactors approximated(const MatrixXd& matrix, double tolerance) {
  return cross_approximation({matrix.rows(), matrix.cols(),
                              [&](Index row, double* values) {
                                Eigen::Map<VectorXd>(values, matrix.cols()) = matrix.row(row).transpose();
                              },
                              [&](Index column, double* values) {
                                Eigen::Map<VectorXd>(values, matrix.rows()) = matrix.col(column);
                              }},
                             tolerance);
}

TEST(CrossApproximation, OfALowRankMatrixIsExact) {
  const MatrixXd left = MatrixXd::Random(30, 4), right = MatrixXd::Random(4, 50), matrix = left * right;
  const LowRankFactors factors = approximated(matrix, 1e-12);
  EXPECT_EQ(factors.rows.rows(), 4);
  EXPECT_LT((factors.rows.transpose() * factors.columns - matrix).norm(), 1e-12 * matrix.norm());
}

TEST(CrossApproximation, SeesAPartThatTheFirstCrossesMiss) {
  // Two blocks without common rows or columns: crosses of one know nothing of the other.
  MatrixXd matrix = MatrixXd::Zero(40, 40);
  matrix.topLeftCorner(20, 20).setConstant(2);
  matrix.bottomRightCorner(20, 20).setConstant(1);
  const LowRankFactors factors = approximated(matrix, 1e-6);
  EXPECT_LT((factors.rows.transpose() * factors.columns - matrix).norm(), 1e-6 * matrix.norm());
}

TEST(PanelOperators, MultiplyAsTheWholeMatrixDoes) {
  const PanelMesh mesh = two_balls();
  const MatrixXd whole = single_layer_matrix(mesh.panels(), 1e-6).selfadjointView<Eigen::Upper>();
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

/// Solves for the charges on rows of boxes that are separated by a gap; returns the number of iterations.
int iterations(int boxes, double gap) {
  PanelMesh mesh;
  for (int k = 0; k < boxes; ++k)
    mesh.add(static_cast<std::size_t>(k),
             test::shifted(triangulate(Cuboid{1, 1, 1}), Vector3d(1 + gap, 0, 0) * k), {1e-2, 2000});
  const PanelOperator panels(mesh, 1e-5, nullptr, 2);
  const auto [areas, bodies] = areas_and_bodies(mesh, panels.tree());
  MatrixXd potentials = MatrixXd::Zero(areas.size(), boxes);
  for (std::size_t place = 0; place < bodies.size(); ++place)
    potentials(static_cast<Index>(place), static_cast<Index>(bodies[place])) = 1;
  const BorderedMatrix matrix{MatrixXd(0, 0), Eigen::MatrixXf(0, areas.size()), panels.matrix(), VectorXd()};
  // As many panels together as PanelSystem takes of up to 4,000.
  const CoarseSpace coarse = coarse_space(panels.matrix(), areas, bodies, 4);
  const TwoLevelPreconditioner preconditioner(matrix, coarse, 1e-5, 2);
  EXPECT_TRUE(preconditioner.is_positive_definite());
  const SpaceSolution solution =
      solve_space(matrix, preconditioner, potentials, VectorXd::Constant(boxes, 1e-6),
                  MatrixXd::Zero(areas.size(), boxes));
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

}  // namespace
}  // namespace fringe::detail::FRINGE_TEST_FILE
