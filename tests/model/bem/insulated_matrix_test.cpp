#include "bem/insulated_matrix.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <vector>

#include <gtest/gtest.h>

#include "bem/insulated_equations.hpp"
#include "bem/insulated_solutions.hpp"
#include "bem/insulated_system.hpp"
#include "bem/single_layer_panels.hpp"
#include "scenes.hpp"

/// The matrix of conductors and dielectric bodies in blocks, against all its elements, and the iteration that
/// solves with it.
namespace fringe::detail::FRINGE_TEST_FILE {
namespace {

using namespace test;
using Eigen::Index;
using Eigen::MatrixXd;

/// A ball before a dielectric one, in more panels than are factorised.
class InsulatedMatrixTest : public testing::Test {
 protected:
  static InsulatedBodies make_bodies() {
    Scene scene;
    scene.objects = {object("ball", Sphere{0.01, 12}, at(0, 0, 0)),
                     object("glass", Sphere{0.02, 16}, at(0, 0, 0.032), Dielectric{5})};
    return insulated_bodies(scene);
  }

  static PanelMesh make_mesh(const InsulatedBodies& bodies) {
    PanelMesh mesh;
    const auto surfaces = divided_surfaces(bodies);
    for (std::size_t body = 0; body < surfaces.size(); ++body)
      mesh.add(body, surfaces[body]);
    return mesh;
  }

  static DoubleLayer make_double_layer(const PanelMesh& mesh) {
    std::vector<bool> is_source;
    for (const PanelGroup& group : mesh.groups())
      is_source.insert(is_source.end(), group.count, group.body == 1);
    return double_layer_of(mesh.panels(), mesh.panels(), is_source, tolerance, {{}, {}}, 1);
  }

  /// Returns the space in which all unknowns are as they are.
  CombinedFunctions whole() const {
    const Index size = equations.unknowns.size();
    CombinedFunctions result{std::vector<Index>(static_cast<std::size_t>(size)), Eigen::VectorXd::Ones(size),
                             Eigen::VectorXd::Ones(size), size};
    std::iota(result.place.begin(), result.place.end(), 0);
    return result;
  }

  static constexpr double tolerance = 1e-5;
  const InsulatedBodies bodies = make_bodies();
  const Surroundings surroundings{bodies, everything(bodies)};
  const PanelMesh mesh = make_mesh(bodies);
  const PanelOperator single_layer{mesh, tolerance, nullptr, 1};
  const InsulatedEquations equations =
      insulated_equations(mesh, bodies, surroundings, single_layer, make_double_layer(mesh), 1);
};

TEST_F(InsulatedMatrixTest, AProductIsThatOfAllItsElements) {
  const MatrixXd all = equations.matrix.combined(whole());
  const MatrixXd values = MatrixXd::NullaryExpr(all.cols(), 2, [](Index row, Index column) {
    return std::sin(1 + 37.0 * static_cast<double>(row * 7 + column));
  });
  EXPECT_TRUE(equations.matrix.times(values).isApprox(all * values, 1e-6));
}

TEST_F(InsulatedMatrixTest, ChargesActByTheSingleLayerAndPotentialsOfInterfacesByTheirJumps) {
  const InsulatedUnknowns& unknowns = equations.unknowns;
  const MatrixXd all = equations.matrix.combined(whole());
  const MatrixXd upper = single_layer_matrix(mesh.panels(), tolerance);
  const MatrixXd layer = upper.selfadjointView<Eigen::Upper>();
  double error = 0, potential_of_one = 0;
  for (Index row = 0; row < unknowns.size(); ++row) {
    double sum = 0;
    for (Index k = 0; k < unknowns.size(); ++k)
      if (unknowns.is_charge(k))
        error = std::max(error, std::abs(all(row, k) - layer(unknowns.panels[static_cast<std::size_t>(row)],
                                                             unknowns.panels[static_cast<std::size_t>(k)])));
      else
        sum += all(row, k);
    // A potential that is constant on the closed surface of a dielectric body is that of no charge: the mean
    // of both permittivities less one is there, and nothing elsewhere, less the mean that stands for it.
    potential_of_one = std::max(potential_of_one, std::abs(sum + (unknowns.is_charge(row) ? 0 : 1)));
  }
  EXPECT_LT(error, 1e-4 * layer.maxCoeff());
  EXPECT_LT(potential_of_one, 1e-9);
}

TEST_F(InsulatedMatrixTest, BlocksHaveTheElementsOfNeighboursAndPointsForOthers) {
  const MatrixXd all = equations.matrix.combined(whole());
  std::vector<Index> some;
  for (const std::size_t leaf : equations.matrix.leaves_near(0))
    for (Index k = 0; k < equations.matrix.leaf(leaf).count; ++k)
      some.push_back(equations.matrix.leaf(leaf).first + k);
  std::sort(some.begin(), some.end());
  const MatrixXd block = equations.matrix.block(some), truth = all(some, some);
  const Index own = equations.matrix.leaf(0).count;
  ASSERT_GT(block.rows(), own);
  EXPECT_TRUE(block.topRows(own).isApprox(truth.topRows(own), 1e-6));
  EXPECT_TRUE(block.isApprox(truth, 1e-2));
}

TEST_F(InsulatedMatrixTest, SolutionsOfBothSpacesLeaveNoResidual) {
  const InsulatedUnknowns& unknowns = equations.unknowns;
  ASSERT_GT(unknowns.size(), 1200);
  const InsulatedSolutions found = solved(unknowns, equations.matrix, equations.potentials, 2);
  const MatrixXd left = equations.potentials - equations.matrix.times(found.fine);
  EXPECT_LT(left.norm(), 1e-6 * equations.potentials.norm());
  const MatrixXd coarse_left =
      unknowns.coarse.means(equations.potentials - equations.matrix.times(found.coarse));
  EXPECT_LT(coarse_left.norm(), 1e-6 * equations.potentials.norm());
  EXPECT_LT(unknowns.coarse.combined(found.details).norm(), 1e-9 * found.fine.norm());
}

TEST(InsulatedSystem, PanelsOfConductorsThatNearlyCoincideGetARidge) {
  const auto largest_ridge_effect = [](double distance) {
    Scene scene;
    scene.objects = {object("shell", Disc{0.04, 16}, at(0, 0, 0)),
                     object("liner", Disc{0.04, 16}, at(0, 0, distance)),
                     object("glass", Sphere{0.02, 8}, at(0, 0, 0.05), Dielectric{5})};
    const InsulatedBodies bodies = insulated_bodies(scene);
    InsulatedSystem system(bodies, {}, {}, 1);
    system.evaluate(1e-3);
    return system.ridge_effects().maxCoeff();
  };
  EXPECT_GT(largest_ridge_effect(1e-6), 0);
  EXPECT_EQ(largest_ridge_effect(1e-4), 0);
}

}  // namespace
}  // namespace fringe::detail::FRINGE_TEST_FILE
