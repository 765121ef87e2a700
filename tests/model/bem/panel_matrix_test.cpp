#include "bem/group_densities.hpp"

#include <cstddef>
#include <limits>
#include <set>
#include <utility>
#include <vector>

#include <Eigen/Eigenvalues>
#include <gtest/gtest.h>

#include "bem/bordered_matrix.hpp"
#include "bem/cluster_tree.hpp"
#include "bem/hierarchical_matrix.hpp"
#include "bem/panel_operator.hpp"
#include "bem/single_layer_panels.hpp"
#include "bem/two_level_preconditioner.hpp"
#include "fringe/triangulation.hpp"

/// The single-layer matrix of panels in blocks: its tree, its restrictions, its border and its
/// preconditioner, against all its elements. Tests what one density on each group of panels can hold.
namespace fringe::detail::FRINGE_TEST_FILE {
namespace {

using detail::PanelGroup;
using detail::PanelMesh;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Returns a matrix of numbers without order, the same in every run.
MatrixXd numbers(Index rows, Index columns) {
  return MatrixXd::NullaryExpr(rows, columns, [](Index row, Index column) {
    return std::sin(1 + 37.0 * static_cast<double>(row * 7 + column));
  });
}

/// A ball and a cube beside it.
class PanelMatrix : public testing::Test {
 protected:
  static PanelMesh make_mesh() {
    PanelMesh mesh;
    mesh.add(0, triangulate(Sphere{0.05, 10}));
    std::vector<Triangle> cube = triangulate(Cuboid{0.05, 0.05, 0.05});
    for (Triangle& triangle : cube)
      for (Eigen::Vector3d& corner : triangle)
        corner.x() += 0.15;
    mesh.add(1, cube);
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
      for (const Eigen::Vector3d& corner : panel.corners)
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
  std::vector<Triangle> ball = triangulate(Sphere{0.02, 16});
  for (Triangle& triangle : ball)
    for (Eigen::Vector3d& corner : triangle)
      corner.x() += 0.55;
  beside.add(1, ball);
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
  const ClusterTree& tree = panels.tree();
  VectorXd areas(matrix.size());
  std::vector<std::size_t> bodies;
  for (const Index g : tree.groups()) {
    const PanelGroup& group = mesh.groups()[static_cast<std::size_t>(g)];
    bodies.insert(bodies.end(), group.count, group.body);
  }
  for (Index place = 0; place < areas.size(); ++place)
    areas[place] =
        mesh.panels()[static_cast<std::size_t>(tree.panels()[static_cast<std::size_t>(place)])].area;
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

/// Returns a mesh of a ball of panels in groups of about four, and a box of quartered triangles.
PanelMesh ball_and_box() {
  PanelMesh mesh;
  mesh.add(0, triangulate(Sphere{0.02, 24}));
  std::vector<Triangle> box = triangulate(Cuboid{0.03, 0.02, 0.01});
  for (Triangle& triangle : box)
    for (Eigen::Vector3d& corner : triangle)
      corner.z() += 0.05;
  mesh.add(1, box);
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
  const VectorXd shares = detail::area_shares(mesh);
  EXPECT_LT((charges.rowwise().sum() - shares).cwiseAbs().maxCoeff(), 1e-15);
  const MatrixXd values = MatrixXd::Random(charges.rows(), 3);
  EXPECT_LT((detail::group_means(mesh, shares, values) - charges.transpose() * values).norm(), 1e-13);
}

TEST(GroupDensities, InteractAsTheirPanelsDoTogether) {
  const PanelMesh mesh = ball_and_box();
  const MatrixXd panels = detail::single_layer_matrix(mesh.panels(), 1e-3);
  const MatrixXd charges = charges_of_groups(mesh);
  const MatrixXd wanted = charges.transpose() * (panels.selfadjointView<Eigen::Upper>() * charges);
  const MatrixXd found = detail::group_matrix(mesh, detail::area_shares(mesh), panels);
  EXPECT_LT((found - wanted).triangularView<Eigen::Lower>().toDenseMatrix().norm(), 1e-13 * wanted.norm());
}

}  // namespace
}  // namespace fringe::detail::FRINGE_TEST_FILE
