#include "fringe/reading.hpp"

#include <gtest/gtest.h>

namespace fringe::FRINGE_TEST_FILE {
namespace {

Object object(const char* name, ElectricalRole role) {
  return {name, std::nullopt, Cuboid{1, 1, 1}, Eigen::Isometry3d::Identity(), role};
}

Scene machine() {
  Scene scene;
  scene.sensors.resize(2);
  scene.sensors[0].name = "front";
  scene.sensors[1].name = "back";
  scene.objects = {object("hand", Floating{}), object("guard", Electrode{}), object("glass", Dielectric{5})};
  return scene;
}

TEST(Readings, AreOneForEverySensorIfTheSceneHasNone) {
  const std::vector<Reading> found = readings(machine());
  ASSERT_EQ(found.size(), 2U);
  EXPECT_EQ(found[1].name, "back");
  EXPECT_EQ(found[1].sense, "back");
  EXPECT_EQ(found[1].drive, std::vector<std::string>{"back"});
  EXPECT_FALSE(found[1].noise.has_value());
  EXPECT_FALSE(found[1].threshold.has_value());
}

TEST(Readings, AreThoseOfTheSceneAlone) {
  Scene scene = machine();
  scene.readings = {{"guarded", "front", {"front", "guard"}}};
  const std::vector<Reading> found = readings(scene);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].name, "guarded");
  EXPECT_EQ(found[0].drive, (std::vector<std::string>{"front", "guard"}));
}

TEST(Readings, HaveAThresholdOfFiveTimesTheNoiseUnlessItIsGiven) {
  Scene scene = machine();
  scene.readings = {{"a", "front", {"front"}, 2.0}, {"b", "front", {"front"}, 2.0, 3.0}};
  EXPECT_EQ(readings(scene)[0].threshold, 10.0);
  EXPECT_EQ(readings(scene)[1].threshold, 3.0);
}

TEST(Targets, AreAllObjectsButElectrodesIfNoneIsMarked) {
  EXPECT_EQ(targets(machine()), (std::vector<bool>{true, false, true}));
}

TEST(Targets, AreThoseThatAreMarkedIfAnyIs) {
  Scene scene = machine();
  scene.objects[2].target = true;
  EXPECT_EQ(targets(scene), (std::vector<bool>{false, false, true}));
}

}  // namespace
}  // namespace fringe::FRINGE_TEST_FILE
