/// Potentials of a machine at rest: what tests/model/test_machine_potentials.py, which compares them with
/// images in a ball, cannot see.

#include "fringe/machine_potentials.hpp"

#include <vector>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

namespace fringe::FRINGE_TEST_FILE {
namespace {

TEST(MachinePotentials, ChangesHaveTheSameBitsForAnyNumberOfThreads) {
  Scene scene;
  scene.sensors.push_back({"front", {}, 2.5, 5e-12, {{{-0.05, -0.05, 0}, {0.1, 0, 0}, {0, 0.1, 0}}}});
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

}  // namespace
}  // namespace fringe::FRINGE_TEST_FILE
