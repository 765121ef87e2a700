/// Potentials of a machine's charges outside of it, by points, by tables and at the points of bodies, against
/// what holds of every potential.

#include "reduced/outside_potentials.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <vector>

#include <gtest/gtest.h>

#include "fringe/machine_potentials.hpp"
#include "fringe/reading.hpp"
#include "geometry.hpp"
#include "reduced/charge_functions.hpp"
#include "reduced/linked_machine.hpp"
#include "reduced/potential_table.hpp"
#include "scenes.hpp"

namespace fringe::detail::FRINGE_TEST_FILE {
namespace {

using Eigen::Index;
using Eigen::MatrixXf;
using Eigen::Vector3d;

/// A sensor before a housing.
class OutsidePotentialsTest : public testing::Test {
 protected:
  static Scene scene() {
    Scene result = test::scene_of(test::square(0.06, 0),
                                  {test::object("housing", Cuboid{0.1, 0.08, 0.03}, test::at(0, 0, -0.03))});

    return result;
  }
  static ChargedBodies bodies() { return charged_bodies(scene()); }

  double given_at(const Vector3d& point) const {
    return potentials.at(std::vector{point}, false, nullptr, 1).of_given(0, 0);
  }

  const LinkedMachine whole{{bodies()}, readings(scene()), {}, {}, {{0.1, 800, 40, 100}, {}}, 1};
  const MachineLink& machine = whole.links().front();
  const OutsidePotentials potentials{machine.functions()};
  const Index functions = static_cast<Index>(machine.functions().count());
};

TEST_F(OutsidePotentialsTest, AreThoseOfAPointFarAwayAndOneAtWhatIsDriven) {
  const Vector3d far(30, 40, 0);
  const OutsidePotentials::Values values = potentials.at(std::vector{far}, true, nullptr, 1);
  ASSERT_EQ(values.of_functions.cols(), functions);
  for (Index function = 0; function < functions; ++function)
    EXPECT_NEAR(values.of_functions(0, function) * 50, 1, 3e-3);
  // The sensor's charge and that on the housing nearly cancel.
  const Eigen::VectorXf charges = machine.functions().panels().given.col(0);
  EXPECT_NEAR(values.of_given(0, 0) * 50, charges.sum(), 2e-3 * charges.cwiseAbs().sum());
  // The sensor is at unit potential, the housing grounded.
  EXPECT_NEAR(given_at({0, 0, 0.001}), 1, 0.05);
  EXPECT_NEAR(given_at({0, 0, -0.046}), 0, 0.05);
}

// The mean over a sphere with no charge inside is the value in its centre: by 26 points, exact to degree 7.
TEST_F(OutsidePotentialsTest, AreHarmonic) {
  test::Random random(1);
  for (int i = 0; i < 10; ++i) {
    const Vector3d centre = random.in_box({-0.1, -0.1, 0.06}, {0.1, 0.1, 0.2});
    constexpr double radius = 0.02;
    double sum = 0;
    for (int x = -1; x <= 1; ++x)
      for (int y = -1; y <= 1; ++y)
        for (int z = -1; z <= 1; ++z) {
          const int places = std::abs(x) + std::abs(y) + std::abs(z);
          if (places == 0)
            continue;
          const double weight = places == 1 ? 40.0 / 840 : places == 2 ? 32.0 / 840 : 27.0 / 840;
          sum += weight * given_at(centre + radius * Vector3d(x, y, z).normalized());
        }
    EXPECT_NEAR(sum, given_at(centre), 2e-3 * std::abs(given_at(centre)) + 1e-5);
  }
}

// Charges outside are attracted: what the machine answers lowers their energy.
TEST_F(OutsidePotentialsTest, AtBodiesAreTheSameAndTheirAnswersAttract) {
  const std::vector<Vector3d> points{{0, 0, 0.05}, {0.05, 0.02, 0.06}, {-0.2, 0.1, 0}, {1, 0, 0}};
  const Eigen::MatrixXd answers = charges_by_potentials(machine.functions().energies());
  const MatrixXf factor = answers.llt().matrixL().toDenseMatrix().cast<float>();
  const OutsidePotentials::Values values = potentials.at(points, true, &factor, 1);
  const MatrixXf answered = values.of_functions * values.of_functions.transpose();
  for (std::size_t k = 0; k < points.size(); ++k)
    EXPECT_NEAR(values.of_given(static_cast<Index>(k), 0), given_at(points[k]), 1e-5);
  EXPECT_GT(answered.diagonal().minCoeff(), 0);
  // The nearest one is attracted most, and all less than by a plane at its distance.
  EXPECT_GT(answered(0, 0), answered(2, 2));
  EXPECT_LT(answered(0, 0), 1 / (2 * 0.05) * 1.05);
}

TEST_F(OutsidePotentialsTest, ATableHasTheirGradients) {
  PotentialTable table(potentials, 0.1);
  const Vector3d point(0.02, 0.01, 0.05);
  table.add(point);
  table.fill(MatrixXf::Identity(functions, functions), 1);
  const std::optional<std::size_t> cell = table.find(point);
  ASSERT_TRUE(cell);
  EXPECT_FALSE(table.find({10, 10, 10}));
  EXPECT_EQ(table.centres().size(), table.count());
  PotentialTable::WrenchWeights weights{};
  table.add_wrench_weights(*cell, point, 1, weights);
  const auto sum = [&](const std::array<float, PotentialTable::nodes>& of_nodes) {
    double result = 0;
    for (std::size_t node = 0; node < PotentialTable::nodes; ++node)
      result += of_nodes[node] * table.values(*cell)[node * table.width()];
    return result;
  };
  Vector3d gradient, moment, difference;
  constexpr double step = 1e-3;
  for (int axis = 0; axis < 3; ++axis) {
    gradient[axis] = sum(weights[static_cast<std::size_t>(axis)]);
    moment[axis] = sum(weights[static_cast<std::size_t>(axis + 3)]);
    difference[axis] =
        (given_at(point + step * Vector3d::Unit(axis)) - given_at(point - step * Vector3d::Unit(axis))) /
        (2 * step);
  }
  EXPECT_LT((gradient - difference).norm(), 0.02 * difference.norm());
  EXPECT_LT((moment - (point - table.centre(*cell)).cross(gradient)).norm(), 1e-4 * gradient.norm());
  table.clear();
  EXPECT_EQ(table.count(), 0U);
  EXPECT_FALSE(table.find(point));
}

// tests/model/test_machine_potentials.py compares them with images in a ball.
TEST(MachinePotentials, ChangesHaveTheSameBitsForAnyNumberOfThreads) {
  Scene scene;
  scene.sensors = {test::sensor("front", {test::square(0.1, 0)})};
  const MachinePotentials machine(scene);
  const MachinePotentials::Body body{{{0, 0, 0}, {0.01, 0, 0}},
                                     (Eigen::Matrix2d() << 200, 100, 100, 200).finished()};
  std::vector<Eigen::Isometry3d> poses;
  for (int k = 0; k < 300; ++k)
    poses.emplace_back(Eigen::Translation3d(0.001 * k - 0.15, 0.02, 0.05 + 0.0005 * k));
  std::vector<Eigen::Vector3d> places;
  for (const Eigen::Isometry3d& pose : poses)
    places.emplace_back(pose.translation());
  const auto by = [&](std::size_t threads) {
    return machine.changes(body, poses, machine.answers(places, threads), {}, threads);
  };
  const MachinePotentials::Changes alone = by(1), together = by(3);
  EXPECT_GT(alone.values.minCoeff(), 0);
  EXPECT_EQ(alone.values, together.values);
}

TEST(MortonsCurve, VisitsEveryPointOnceAndNeighboursTogether) {
  test::Random random(2);
  std::vector<Vector3d> points;
  for (int i = 0; i < 200; ++i)
    points.push_back(random.in_box({0, 0, 0}, {1, 1, 1}));
  std::vector<std::size_t> order = along_curve(points);
  double along = 0, given = 0;
  for (std::size_t k = 1; k < points.size(); ++k) {
    along += (points[order[k]] - points[order[k - 1]]).norm();
    given += (points[k] - points[k - 1]).norm();
  }
  EXPECT_LT(along, given / 2);
  std::sort(order.begin(), order.end());
  for (std::size_t k = 0; k < points.size(); ++k)
    EXPECT_EQ(order[k], k);
}

}  // namespace
}  // namespace fringe::detail::FRINGE_TEST_FILE
