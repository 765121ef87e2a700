/// What a target changes in the readings of a machine of two links, prepared apart from each other: against
/// boundary elements of the whole, and what must not matter.

#include "reduced/moving_solver.hpp"

#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "fringe/boundary_elements.hpp"
#include "fringe/pose.hpp"
#include "fringe/reading.hpp"
#include "reduced/link_tables.hpp"
#include "reduced/linked_machine.hpp"
#include "scenes.hpp"
#include "surface/placed_box.hpp"

namespace fringe::detail::FRINGE_TEST_FILE {
namespace {

const Cuboid housing{0.12, 0.1, 0.04}, hand{0.05, 0.09, 0.02};

Scene sensor_alone() {
  Scene scene;
  scene.sensors = {test::sensor("sensor", {test::square(0.06, 0)})};
  return scene;
}
Scene body_alone(const char* name, const Shape& shape) {
  Scene scene;
  scene.objects = {test::object(name, shape, test::at(0, 0, 0))};
  return scene;
}

/// The change by the hand over 4πε by boundary elements.
double truth(const PoseOfMachine& pose) {
  Scene scene = sensor_alone();
  scene.links = {{"sensor", {}, pose.links[0]}, {"housing", {}, pose.links[1]}, {"hand", {}, pose.target}};
  scene.sensors[0].link = 0;
  scene.objects = {test::on_link(1, test::object("housing", housing, test::at(0, 0, 0))),
                   test::on_link(2, test::target(test::object("hand", hand, test::at(0, 0, 0))))};
  return maxwell(scene, {.rtol = 3e-3}).readings.at(0).change.value.value() /
         (4 * std::numbers::pi * vacuum_permittivity);
}

/// A sensor that moves before a housing, and a hand.
struct Prepared {
  static constexpr double rtol = 0.05;

  static PoseOfMachine pose(double gap, double turn, const Eigen::Vector3d& place) {
    return {{pose_from_axis({0, 1, 0}, turn, {0, 0, 0}), test::at(0, 0, -gap)},
            pose_from_axis({1, 2, 3}, 20, place)};
  }

  Prepared() { tables.extend(machine, target, poses, 1); }

  double change(const PoseOfMachine& at, double* error = nullptr) {
    const SolvedReading found = solver.solved(machine, tables, target, at)[0];
    if (error != nullptr)
      *error = found.error;
    return found.change;
  }

  const std::vector<PoseOfMachine> poses{pose(0.035, 0, {0.01, 0.02, 0.05}), pose(0.06, 25, {-0.02, 0, 0.07}),
                                         pose(0.035, -10, {0.03, 0.03, 0.12})};
  const ChargedBodies hand_bodies = charged_bodies(body_alone("hand", hand));
  const LinkedMachine machine{
      {charged_bodies(sensor_alone()), charged_bodies(body_alone("housing", housing))},
      readings(sensor_alone()),
      poses,
      {bounds_of(hand_bodies.bodies[0])},
      machine_resolution(rtol, false, false),
      1};
  const TargetAtRest target{hand_bodies, {rtol, 6000, 384}, machine.approach(poses, LinkedMachine::none)};
  LinkTables tables{machine, target};
  MovingSolver solver;
};

/// All tests share what is prepared.
Prepared& prepared() {
  static Prepared of_all;
  return of_all;
}

TEST(MovingSolver, IsTheChangeByBoundaryElementsInEveryPose) {
  for (const PoseOfMachine& at : prepared().poses) {
    double error = 0;
    const double found = prepared().change(at, &error), expected = truth(at);
    EXPECT_NEAR(found, expected, error + 3e-3 * expected);
    EXPECT_NEAR(found, expected, 0.05 * expected);
    EXPECT_GT(error, 0);
    EXPECT_LT(error, 0.5 * expected);
  }
}

// Only poses relative to each other count, not what was evaluated before.
TEST(MovingSolver, DoesNotDependOnWhereEverythingIsNorOnEarlierPoses) {
  Prepared& all = prepared();
  const std::vector<PoseOfMachine>& poses = all.poses;
  const double first = all.change(poses[0]);
  all.change(poses[1]);
  EXPECT_NEAR(all.change(poses[0]), first, 1e-5 * first);
  const Eigen::Isometry3d away = pose_from_axis({3, 1, -1}, 130, {5, -2, 1});
  const PoseOfMachine moved{{away * poses[0].links[0], away * poses[0].links[1]}, away * poses[0].target};
  EXPECT_NEAR(all.change(moved), first, 1e-4 * first);
  EXPECT_NEAR(nearness(all.machine, all.target, moved), nearness(all.machine, all.target, poses[0]), 1e-9);
  EXPECT_GT(nearness(all.machine, all.target, poses[0]), nearness(all.machine, all.target, poses[2]));
}

}  // namespace
}  // namespace fringe::detail::FRINGE_TEST_FILE
