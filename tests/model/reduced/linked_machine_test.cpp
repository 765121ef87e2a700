#include <cmath>
#include <string>
#include <vector>

#include <gmock/gmock.h>

#include "fringe/error.hpp"
#include "fringe/live_scene.hpp"
#include "fringe/pose.hpp"
#include "reduced/surrounded.hpp"
#include "scenes.hpp"

/// The readings of machines whose links move against each other (model/CORRECTIONS.md,
/// section 8, "Links that move").
namespace fringe::FRINGE_TEST_FILE {
namespace {

using namespace test;
using testing::AllOf;
using testing::HasSubstr;
using testing::ThrowsMessage;

constexpr double accuracy = 5e-2;

Eigen::Isometry3d turned(double degrees, const Eigen::Vector3d& place) {
  return pose_from_axis({0, 1, 0}, degrees, place);
}

/// A foot, an upper arm and a forearm that overlap in two joints, sensors on the arms, and a hand.
Scene arm() {
  Scene scene;
  scene.links = {{"foot", std::nullopt, Eigen::Isometry3d::Identity()},
                 {"upper arm", 0, at(0, 0, 0.08)},
                 {"forearm", 1, at(0, 0, 0.2)},
                 {"hand", std::nullopt, at(0.2, 0, 0.3)}};
  scene.objects = {on_link(0, object("foot", Cuboid{0.16, 0.16, 0.1}, at(0, 0, 0.05))),
                   on_link(1, object("upper arm", Cuboid{0.06, 0.06, 0.24}, at(0, 0, 0.1))),
                   on_link(2, object("forearm", Cuboid{0.05, 0.05, 0.2}, at(0, 0, 0.09))),
                   on_link(3, target(object("hand", Cuboid{0.03, 0.09, 0.1}, at(0, 0, 0))))};
  const auto add = [&](const std::string& name, std::size_t link, double x, double z) {
    const Rectangle plate{{x, -0.025, z}, {0, 0.05, 0}, {0, 0, 0.08}};
    scene.sensors.push_back(on_link(link, sensor(name, {plate})));
  };
  add("above", 2, 0.035, 0.08);
  add("below", 1, 0.04, 0.07);
  scene.readings = {
      {"above", "above", {"above"}}, {"below", "below", {"below"}}, {"across", "above", {"below"}}};
  return scene;
}

/// Both joints turn.
std::vector<Frame> motion(const Scene& scene, int frames = 10) {
  std::vector<Frame> result;
  for (int k = 0; k < frames; ++k) {
    Frame& frame = result.emplace_back(Frame{std::to_string(k), {}});
    for (const Link& link : scene.links)
      frame.poses.push_back(link.pose);
    frame.poses[1] = turned(-2.0 * k, {0, 0, 0.08});
    frame.poses[2] = turned(4.0 * k, {0, 0, 0.2});
  }
  return result;
}

std::vector<ReadingAnswer> alone(const Scene& scene, const Frame& frame) {
  Surrounded live(scene);
  live.set_poses(frame.poses);
  return live.answers(accuracy);
}

TEST(LinkedMachineAtLength, IsNearBoundaryElementsInEveryPose) {
  const Scene scene = arm();
  const std::vector<Frame> frames = motion(scene);
  Surrounded live(scene);
  const std::vector<std::vector<ReadingAnswer>> found = live.answers_of(frames, accuracy, 2);
  for (const std::size_t frame : {0, 9}) {
    LiveScene there(scene);
    there.set_poses(frames[frame].poses);
    const std::vector<ReadingAnswer> truth = there.readings({.method = BoundaryElements{}, .rtol = 2e-2});
    expect_agreement(found[frame], truth);
    for (std::size_t k = 0; k < truth.size(); ++k) {
      const double change = truth[k].change.value.value(), background = truth[k].background.value.value();
      EXPECT_NEAR(found[frame][k].change.value.value(), change, 0.04 * std::abs(change)) << truth[k].name;
      EXPECT_NEAR(found[frame][k].background.value.value(), background, 0.04 * std::abs(background))
          << truth[k].name;
    }
  }
}

TEST(LinkedMachine, AnswersAsTheSceneByItself) {
  const Scene scene = arm();
  const std::vector<Frame> frames = motion(scene);
  const std::vector<ReadingAnswer> known = alone(scene, frames[5]);
  Surrounded motion_of_one(scene), live(scene);
  expect_agreement(motion_of_one.answers_of({frames[5]}, accuracy, 1).front(), known);
  // Once its links have moved, a live scene does not prepare them again.
  live.answers(accuracy);
  live.set_poses(frames[5].poses);
  expect_agreement(live.answers(accuracy), known);
}

TEST(LinkedMachineAtLength, HasTheSameBitsForAnyNumberOfThreads) {
  const Scene scene = arm();
  const std::vector<Frame> frames = motion(scene);
  Surrounded one(scene), two(scene);
  EXPECT_EQ(changes_and_errors(one.answers_of(frames, accuracy, 1)),
            changes_and_errors(two.answers_of(frames, accuracy, 2)));
}

/// Expects the derivatives by a link's pose to be central differences of the changes.
void expect_differences(Surrounded& live, const std::string& link, std::size_t number) {
  const std::vector<ReadingAnswer> found = live.answers(accuracy, true);
  const Eigen::Isometry3d pose = live.scene().links[number].pose;
  // Longer steps than the jumps between cells of the tables and between levels of points need; shorter than
  // those in which the changes curve.
  constexpr double step = 5e-4, arm = 0.1;
  std::vector<PoseDerivatives> differences(found.size(), PoseDerivatives::Zero());
  for (int coordinate = 0; coordinate < 6; ++coordinate) {
    const Eigen::Vector3d axis = Eigen::Vector3d::Unit(coordinate % 3);
    const double amount = coordinate < 3 ? step : step / arm;
    for (const double sign : {1.0, -1.0}) {
      Eigen::Isometry3d moved = pose;
      // The world's axes are those of the links' parents here.
      if (coordinate < 3)
        moved.pretranslate(sign * amount * axis);
      else
        moved.linear() = Eigen::AngleAxisd(sign * amount, axis) * pose.linear();
      live.set_pose(link, moved);
      const std::vector<ReadingAnswer>& there = live.answers(accuracy);
      for (std::size_t k = 0; k < found.size(); ++k)
        differences[k][coordinate] += sign * there[k].change.value.value() / (2 * amount);
    }
  }
  live.set_pose(link, pose);
  for (std::size_t k = 0; k < found.size(); ++k) {
    const LinkDerivatives& by_link = found[k].derivatives[number];
    EXPECT_EQ(by_link.link, link);
    PoseDerivatives scaled = by_link.change - differences[k];
    scaled.tail<3>() /= arm;
    PoseDerivatives size = differences[k];
    size.tail<3>() /= arm;
    EXPECT_LT(scaled.norm(), 0.02 * size.norm()) << link << ' ' << found[k].name;
  }
}

TEST(LinkedMachine, KnowsDerivativesByThePosesOfAllLinks) {
  Scene scene = arm();
  // The foot's link is that of the world, and the arms overlap as they do in all poses.
  Surrounded live(scene);
  live.set_poses(motion(scene)[3].poses);
  expect_differences(live, "hand", 3);
  expect_differences(live, "upper arm", 1);
}

TEST(LinkedMachine, KnowsConductorsThatFloat) {
  Scene scene = arm();
  scene.sensors.pop_back();
  scene.readings.resize(1);
  scene.objects.push_back(
      on_link(2, object("shield", Cuboid{0.002, 0.05, 0.05}, at(0.07, 0.04, 0.12), Floating{})));
  scene.objects[3].role = Floating{1e-12};
  const std::vector<Frame> frames = motion(scene, 2);
  Surrounded live(scene);
  expect_agreement(live.answers_of(frames, accuracy, 1)[1], alone(scene, frames[1]));
}

TEST(LinkedMachine, RefusesContactOfLinksAtDifferentPotentials) {
  const Scene scene = arm();
  std::vector<Frame> frames = motion(scene, 2);
  // The sensor on the forearm, folded, passes through the upper arm.
  frames[1].poses[2] = turned(160, {0, 0, 0.2});
  Surrounded live(scene);
  EXPECT_THAT([&] { live.answers_of(frames, accuracy, 1); },
              ThrowsMessage<InputError>(AllOf(HasSubstr("sensor \"above\""), HasSubstr("upper arm"))));
}

}  // namespace
}  // namespace fringe::FRINGE_TEST_FILE
