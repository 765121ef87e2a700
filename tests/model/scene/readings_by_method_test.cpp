/// Tests what every method says of readings.

#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "fringe/error.hpp"
#include "scenes.hpp"

namespace fringe::FRINGE_TEST_FILE {
namespace {

using namespace test;

/// Returns a sensor and its guard before a housing, and on a link of its own a hand before them. The hand is
/// the target.
Scene machine() {
  Scene scene = scene_of(square(0.03, 0), {object("guard", Plate{0.05, 0.05}, at(0, 0, -0.004), Electrode{}),
                                           box("housing", {-4, -4, -5}, {4, 4, -1}),
                                           on_link(0, target(box("hand", {-2, -3, 0}, {2, 3, 1})))});
  scene.links = {{"wrist", std::nullopt, at(0, 0, 0.03)}};
  scene.readings = {{"self", "front", {"front"}},
                    {"guarded", "front", {"front", "guard"}},
                    {"transmitted", "front", {"guard"}}};
  return scene;
}

/// Returns the readings by the reduced method, which boundary elements are expected to confirm.
std::vector<ReadingAnswer> confirmed(const Scene& scene, double rtol = 1e-3) {
  const std::vector<ReadingAnswer> reduced = evaluate(scene, {.method = Reduced{}, .rtol = rtol}).readings;
  expect_agreement(reduced, evaluate(scene, {.method = BoundaryElements{}, .rtol = 1e-2}).readings);
  return reduced;
}

TEST(ReadingsByTheModel, AreTheSumOverTheTargetsAndOtherwiseNotKnown) {
  const Evaluation answer = evaluate(machine());
  ASSERT_EQ(answer.readings.size(), 3);
  const std::vector<ObjectCapacitance>& objects = answer.capacitance.sensors.front().objects;
  ASSERT_EQ(objects.back().name, "hand");
  for (const std::size_t k : {0, 1}) {
    EXPECT_EQ(answer.readings[k].change.value, objects.back().capacitance);
    EXPECT_EQ(answer.readings[k].change.error, std::nullopt);
    EXPECT_EQ(answer.readings[k].value.value, std::nullopt);
    EXPECT_EQ(answer.readings[k].background.value, std::nullopt);
    EXPECT_EQ(answer.readings[k].answered_by, "exact");
  }
  EXPECT_EQ(answer.readings[2].change.value, std::nullopt);
}

TEST(ReadingsByTheModel, AreNotKnownIfATargetFloats) {
  Scene scene = machine();
  scene.objects.back().role = Floating{1e-12};
  const Evaluation answer = evaluate(scene);
  EXPECT_EQ(answer.capacitance.sensors.front().objects.size(), 1U) << "the housing has a capacitance still";
  for (const ReadingAnswer& reading : answer.readings)
    EXPECT_EQ(reading.change.value, std::nullopt);
}

TEST(ReadingsByTheModel, AreRefusedForAFloatingObjectIfNoChangeIsAskedFor) {
  Scene scene = machine();
  scene.readings.clear();
  scene.objects = {scene.objects.back()};
  scene.objects.front().target = false;
  scene.objects.front().role = Floating{};
  EXPECT_THROW(evaluate(scene), InputError);
}

TEST(ReadingsByTheModel, OfASceneWithoutTargetsAreTheTotalOfEverySensor) {
  Scene scene = machine();
  scene.objects.back().target = false;
  scene.readings.clear();
  const Evaluation answer = evaluate(scene);
  ASSERT_EQ(answer.readings.size(), 1);
  EXPECT_DOUBLE_EQ(*answer.readings.front().change.value, answer.capacitance.sensors.front().total);
}

TEST(ReadingsByTheReducedMethod, AgreeWithBoundaryElementsWhereverTheHandIs) {
  LiveScene live(machine());
  for (const double height : {0.03, 0.02, 0.03}) {
    live.set_pose("wrist", at(0.005, 0, height));
    const std::vector<ReadingAnswer> reduced = live.evaluate({.method = Reduced{}, .rtol = 1e-3}).readings;
    const std::vector<ReadingAnswer> elements =
        live.evaluate({.method = BoundaryElements{}, .rtol = 1e-2}).readings;
    expect_agreement(reduced, elements);
    for (std::size_t k = 0; k < reduced.size(); ++k) {
      EXPECT_EQ(reduced[k].answered_by, "reduced");
      EXPECT_EQ(elements[k].answered_by, "boundary-elements");
    }
  }
}

TEST(ReadingsByTheReducedMethod, HaveChangesMoreAccurateThanTheirParts) {
  for (const ReadingAnswer& reading : evaluate(machine(), {.method = Reduced{}, .rtol = 1e-3}).readings) {
    EXPECT_NEAR(*reading.change.value, *reading.value.value - *reading.background.value,
                1e-12 * std::abs(*reading.value.value));
    EXPECT_LT(*reading.change.error, 0.01 * std::abs(*reading.change.value));
    EXPECT_LT(*reading.change.error, 0.3 * (*reading.value.error + *reading.background.error));
  }
}

TEST(ReadingsByTheReducedMethod, AreAccurateRelativeToSmallChanges) {
  Scene scene = machine();
  scene.links.front().pose = at(0.1, 0, 0.6);
  for (const ReadingAnswer& reading : confirmed(scene)) {
    EXPECT_LT(std::abs(*reading.change.value), 1e-3 * std::abs(*reading.value.value));
    EXPECT_LT(*reading.change.error, 0.02 * std::abs(*reading.change.value));
  }
}

TEST(ReadingsByTheReducedMethod, FollowEveryMoveAsASceneThere) {
  Scene scene = machine();
  scene.links.push_back({"robot", std::nullopt, at(0, 0, 0)});
  for (Object& object : scene.objects)
    if (!object.link)
      object.link = 1;
  LiveScene live(scene);
  live.evaluate({.method = Reduced{}});
  // The hand moves alone, then the guard and the housing, then the hand again.
  const std::vector<std::pair<std::size_t, Eigen::Isometry3d>> moves{
      {0, at(0, 0.01, 0.02)}, {0, at(0, 0.01, 0.05)}, {1, at(0, 0.002, -0.003)}, {0, at(0, 0, 0.05)}};
  for (const auto& [link, pose] : moves) {
    scene.links[link].pose = pose;
    live.set_pose(scene.links[link].name, pose);
    const std::vector<ReadingAnswer> moved = live.evaluate({.method = Reduced{}}).readings;
    const std::vector<ReadingAnswer> there = evaluate(scene, {.method = Reduced{}}).readings;
    for (std::size_t k = 0; k < moved.size(); ++k) {
      EXPECT_EQ(moved[k].change.value, there[k].change.value);
      EXPECT_EQ(moved[k].background.value, there[k].background.value);
      EXPECT_EQ(moved[k].change.error, there[k].change.error);
    }
  }
}

TEST(ReadingsByTheReducedMethodAtLength, AreKnownOfAHandThatTouchesTheHousing) {
  LiveScene live(machine());
  live.evaluate({.method = Reduced{}});
  // The palm leaves no gap at the housing's side, and is one body with it.
  live.set_pose("wrist", at(0.06, 0, -0.03));
  const std::vector<ReadingAnswer> touching = live.evaluate({.method = Reduced{}}).readings;
  expect_agreement(touching, live.evaluate({.method = BoundaryElements{}, .rtol = 3e-2}).readings);
  live.set_pose("wrist", at(0, 0, 0.03));
  for (const ReadingAnswer& apart : live.evaluate({.method = Reduced{}}).readings)
    EXPECT_LT(*apart.change.error, 0.3 * (*apart.value.error + *apart.background.error));
}

TEST(ReadingsByTheReducedMethod, TakeATargetOfTheMachinesConductorAndFloatingPartsOfIt) {
  Scene scene = machine();
  scene.objects.back().conductor = scene.objects[1].conductor = "robot";
  scene.objects.push_back(object("screw", Plate{0.01, 0.02}, at(0.04, 0, 0), Floating{}));
  for (const ReadingAnswer& reading : confirmed(scene))
    EXPECT_LT(*reading.change.error, 0.02 * std::abs(*reading.change.value));
}

TEST(ReadingsByTheReducedMethod, DoNotChangeWithoutATarget) {
  Scene scene = machine();
  scene.objects.pop_back();
  for (Object& object : scene.objects)
    object.role = Electrode{};
  for (const ReadingAnswer& reading : evaluate(scene, {.method = Reduced{}, .rtol = 1e-3}).readings) {
    EXPECT_NEAR(*reading.change.value, 0, 1e-12 * std::abs(*reading.value.value));
    EXPECT_LE(*reading.change.error, 1e-6 * std::abs(*reading.value.value));
    EXPECT_GT(*reading.value.error, 0);
  }
}

TEST(ReadingsByTheReducedMethod, TakeACapacitanceToTheGround) {
  Scene scene = machine();
  scene.objects.back().role = Floating{1e-12};
  const Estimate connected = confirmed(scene).front().change;
  // The error is small enough to tell a capacitor from none.
  scene.objects.back().role = Floating{};
  const Estimate insulated = evaluate(scene, {.method = Reduced{}, .rtol = 1e-3}).readings.front().change;
  EXPECT_GT(std::abs(*connected.value - *insulated.value), *connected.error + *insulated.error);
}

TEST(ReadingsByTheReducedMethod, OfAPlateCloseToABoxStateErrorsThatHoldAtLooseAccuracies) {
  const Scene scene =
      scene_of(square(0.1, 0.03), {object("house", Cuboid{0.2, 0.2, 0.05}, at(0, 0, 0)),
                                   target(object("hand", Cuboid{0.09, 0.18, 0.03}, at(0, 0, 0.09)))});
  // The field solver proves that they lie between 23.7207 and 23.7347, and between 0.6104 and 0.6375.
  constexpr double value = 23.7277e-12, change = 0.62395e-12;
  for (const double rtol : {0.1, 0.05}) {
    const ReadingAnswer found = evaluate(scene, {.method = Reduced{}, .rtol = rtol}).readings.at(0);
    EXPECT_NEAR(found.value.value.value(), value, found.value.error.value()) << rtol;
    EXPECT_NEAR(found.change.value.value(), change, found.change.error.value()) << rtol;
  }
}

TEST(ReadingsByTheReducedMethod, OfATargetManyTimesLargerThanItsGapAreFoundBeforeAMachine) {
  const Scene scene =
      scene_of(rectangle(0.1177, 0.04861, 0),
               {target(object("wall", Cuboid{2.341, 0.7545043, 1.1651157}, at(-0.522, -0.213, 0.623878))),
                object("house", Cuboid{0.2354, 0.09722, 0.07564}, at(0, 0, -0.05295))});
  // Boundary elements at 1e-4: 0.51966 ± 0.00014 pF. The matrix states an error of half of it.
  constexpr double change = 0.51966e-12;
  for (const double rtol : {0.1, 0.01}) {
    const ReadingAnswer found = evaluate(scene, {.method = Reduced{}, .rtol = rtol}).readings.at(0);
    EXPECT_NEAR(found.change.value.value(), change, found.change.error.value()) << rtol;
    EXPECT_LE(*found.change.error, 0.1 * change) << rtol;
  }
}

TEST(ReadingsByTheReducedMethod, OfABodyOfMoreTrianglesThanItsMatrixTakesAreFoundBeforeAMachine) {
  Scene scene = scene_of(square(0.1, 0), {object("hand", Sphere{0.05, 80}, at(0, 0, 0.1))});
  const Estimate change = confirmed(scene, 0.1).at(0).change;
  EXPECT_LE(*change.error, 0.1 * *change.value);
}

TEST(ReadingsByTheReducedMethod, OfAGapThatItDoesNotResolveAreNotNumbers) {
  Scene scene = machine();
  scene.links[0].pose = at(0, 0, -1);
  scene.objects.push_back(object("wall", Plate{100, 100}, at(0, 0, -1)));
  scene.objects.back().target = false;
  const Evaluation answer = evaluate(scene, {.method = Reduced{}, .rtol = 0.1});
  for (const ReadingAnswer& reading : answer.readings)
    for (const Estimate& each : {reading.value, reading.background, reading.change})
      EXPECT_TRUE(!each.value || !each.error || std::isfinite(*each.error));
}

}  // namespace
}  // namespace fringe::FRINGE_TEST_FILE
