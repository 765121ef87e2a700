#include "reduced/tabulated_solver.hpp"

#include <array>
#include <optional>
#include <random>
#include <vector>

#include <Eigen/Cholesky>
#include <gtest/gtest.h>

#include "fringe/pose.hpp"
#include "fringe/reading.hpp"
#include "scenes.hpp"

namespace fringe::detail::FRINGE_TEST_FILE {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::MatrixXf;
using Eigen::Vector3d;

/// A sensor 3 mm before a housing, and a hand at the origin.
class TabulatedSolverTest : public testing::Test {
 protected:
  static Scene machine_scene() {
    Scene scene = test::hand_before_housing(0);
    scene.objects.pop_back();
    return scene;
  }
  static Scene hand_scene() {
    Scene scene;
    scene.objects = {test::object("hand", Cuboid{0.05, 0.09, 0.02}, test::at(0, 0, 0))};
    return scene;
  }

  static constexpr MachineResolution resolution{{5e-2, 2000, 100, 400}, {}};
  const LinkedMachine whole{
      {charged_bodies(machine_scene())}, readings(machine_scene()), {}, {}, resolution, 1};
  const MachineLink& machine = whole.links().front();
  const Eigen::Isometry3d pose = pose_from_axis({1, 2, 3}, 0.4, {0.02, 0.01, 0.06});
  const TargetAtRest target{charged_bodies(hand_scene()), {5e-2, 1000, 48}, approach(pose)};
  const OutsidePotentials potentials{machine.functions()};

  Approach approach(const Eigen::Isometry3d& of_target) const {
    return whole.approach(std::vector<PoseOfMachine>{{{Eigen::Isometry3d::Identity()}, of_target}},
                          LinkedMachine::none);
  }
};

TEST_F(TabulatedSolverTest, TablesKnowThePotentialsToAPartInThousand) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> beside(-0.15, 0.15), above(0.01, 0.2);
  std::vector<Vector3d> points;
  PotentialTable table(potentials, 0.1);
  // The smallest cells have sides of 0.4 mm; points within the spheres around large panels have none.
  constexpr double enough = 1e-3;
  while (points.size() < 100) {
    // One after the other: the order in which arguments are evaluated depends on the compiler.
    const double x = beside(random), y = beside(random), z = above(random);
    if (potentials.clearance({x, y, z}) < enough)
      continue;
    points.emplace_back(x, y, z);
    table.add(points.back());
  }
  const auto functions = static_cast<Index>(machine.functions().count());
  const MatrixXf ones = MatrixXf::Identity(functions, functions);
  table.fill(ones, 1);
  const OutsidePotentials::Values expected = potentials.at(points, true, nullptr, 1);
  const Index given = expected.of_given.cols();
  std::vector<float> found(table.width());
  for (std::size_t k = 0; k < points.size(); ++k) {
    const std::optional<std::size_t> cell = table.find(points[k]);
    ASSERT_TRUE(cell) << points[k].transpose();
    EXPECT_TRUE(table.contains(*cell, points[k]));
    std::array<float, PotentialTable::nodes> weights{};
    table.add_weights(*cell, points[k], 1, weights);
    found.assign(table.width(), 0);
    for (std::size_t node = 0; node < PotentialTable::nodes; ++node)
      for (std::size_t value = 0; value < table.width(); ++value)
        found[value] += weights[node] * table.values(*cell)[node * table.width() + value];
    EXPECT_NEAR(found[0], expected.of_given(static_cast<Index>(k), 0), 2e-3);
    for (Index function = 0; function < functions; ++function) {
      const float known = expected.of_functions(static_cast<Index>(k), function);
      EXPECT_NEAR(found[static_cast<std::size_t>(given + function)], known, 5e-3 * known);
    }
  }
}

TEST_F(TabulatedSolverTest, ATableThatIsFullTellsOfNewPlacesAndKeepsThoseThatItHas) {
  constexpr double side = 0.1;
  PotentialTable table(potentials, side);
  int added = 0;
  const auto place = [&](int k) { return Vector3d(1 + 2 * side * k, 0.01, 0.01); };
  while (table.add(place(added)))
    ++added;
  const std::size_t count = table.count();
  EXPECT_EQ(count, static_cast<std::size_t>(added));
  for (int k = 0; k <= added; ++k)
    EXPECT_TRUE(table.add(place(k))) << "was asked for before: " << k;
  EXPECT_FALSE(table.add(place(added + 1)));
  EXPECT_EQ(table.count(), count);
}

TEST_F(TabulatedSolverTest, PointsTooCloseToTheMachineHaveNoCell) {
  PotentialTable table(potentials, 0.1);
  table.add({0, 0, 0.0001});
  EXPECT_EQ(table.count(), 0U);
  EXPECT_FALSE(table.find({0, 0, 0.0001}));
}

// Galerkin's answer with the machine's whole inverse, evaluated directly at 64 points in every function of
// the target, where the solver takes as few as 4: that makes 5e-3 here.
TEST_F(TabulatedSolverTest, IsGalerkinsAnswer) {
  const ChargeFunctions& functions = target.functions();
  const auto count = static_cast<Index>(functions.count()),
             parts = static_cast<Index>(machine.functions().count());
  const FunctionPoints& points = functions.points(ChargeFunctions::points_per_function.size() - 1);
  std::vector<Vector3d> places;
  for (const Eigen::Vector3f& at : points.at)
    places.push_back(pose * at.cast<double>());
  const OutsidePotentials::Values values = potentials.at(places, true, nullptr, 1);
  MatrixXd given = MatrixXd::Zero(count, values.of_given.cols()), coupling = MatrixXd::Zero(count, parts);
  for (std::size_t function = 0; function < functions.count(); ++function)
    for (std::size_t k = points.first[function]; k < points.first[function + 1]; ++k) {
      const auto row = static_cast<Index>(function), point = static_cast<Index>(k);
      given.row(row) += points.shares[k] * values.of_given.row(point).cast<double>();
      coupling.row(row) += points.shares[k] * values.of_functions.row(point).cast<double>();
    }
  const MatrixXd answers = charges_by_potentials(machine.functions().energies());
  const MatrixXd before = functions.energies() - coupling * answers * coupling.transpose();
  const double expected = given.col(0).dot(before.llt().solve(given.col(0)));

  TabulatedMachine tabulated(whole, target);
  tabulated.extend(target, std::vector{pose}, 1);
  TabulatedSolver solver;
  const SolvedReading found = solver.solved(tabulated, target, pose, 1e-3)[0];
  EXPECT_NEAR(found.change, expected, 1e-2 * expected);
  EXPECT_GT(found.error, 0);
  EXPECT_LT(found.error, 0.3 * expected);
}

// The surface of a rounded hand has functions of 33 to 63 triangles, whose points are four times as many.
TEST_F(TabulatedSolverTest, KnowsFunctionsOfManyPoints) {
  Scene scene = hand_scene();
  scene.objects[0].shape = RoundedCuboid{0.03, 0.09, 0.18, 0.01, 24};
  const Eigen::Isometry3d near = test::at(0.02, 0.01, 0.094);
  const TargetAtRest rounded(charged_bodies(scene), {5e-2, 1000, 16}, approach(near));
  TabulatedMachine tabulated(whole, rounded);
  tabulated.extend(rounded, std::vector{near}, 1);
  TabulatedSolver solver;
  const SolvedReading found = solver.solved(tabulated, rounded, near, 1e-1)[0];
  EXPECT_GT(found.change, 0);
  EXPECT_GT(found.error, 0);
  // Another target after it, whose functions have fewer points.
  EXPECT_GT(solver.solved(tabulated, target, pose, 1e-1)[0].change, 0);
}

TEST_F(TabulatedSolverTest, HasForcesWhereNoPointLiesInACell) {
  // Within the housing nothing is clear of the machine.
  const Eigen::Isometry3d inside = test::at(0, 0, -0.028);
  Scene scene = hand_scene();
  scene.objects[0].shape = Cuboid{0.002, 0.002, 0.002};
  const TargetAtRest grain(charged_bodies(scene), {5e-2, 1000, 16}, approach(inside));
  TabulatedMachine tabulated(whole, grain);
  tabulated.extend(grain, std::vector{inside}, 1);
  TabulatedSolver solver;
  solver.solved(tabulated, grain, inside, 1e-1);
  EXPECT_EQ(solver.wrenches(tabulated, grain, inside).size(), 1U);
}

TEST_F(TabulatedSolverTest, PointsFarAwayHaveNoCell) {
  PotentialTable table(potentials, 0.1);
  table.add({0, 0, 0.1});
  const Vector3d far(0, 0, 1e15);
  table.add(far);
  EXPECT_FALSE(table.find(far));
  EXPECT_FALSE(table.find({0, 1e30, 0}));
  // As far away as the cells' numbers along an axis reach, and then as far as the first point.
  EXPECT_FALSE(table.find({0, 0, 0.1 + 0.1 * (1 << 20)}));
}

}  // namespace
}  // namespace fringe::detail::FRINGE_TEST_FILE
