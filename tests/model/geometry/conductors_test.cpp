#include "fringe/conductors.hpp"

#include <gtest/gtest.h>

#include "fringe/pose.hpp"
#include "fringe/reading.hpp"

namespace fringe::FRINGE_TEST_FILE {
namespace {

using Eigen::Vector3d;

Scene scene() {
  Scene scene;
  scene.links.push_back({"table", std::nullopt, pose_from_axis({0, 0, 1}, 0, {0, 0, 10})});
  Object object{"target", 0, Plate{2, 2}, pose_from_axis({0, 0, 1}, 0, {5, 0, 0}), Grounded{}, true};
  scene.objects.push_back(object);
  Sensor sensor;
  sensor.name = "front";
  sensor.link = 0;
  sensor.plates = {{{0, 0, 1}, {1, 0, 0}, {0, 2, 0}}};
  scene.sensors.push_back(sensor);
  return scene;
}

TEST(Conductors, ListTheSensorsFirst) {
  const std::vector<Conductor> surfaces = conductors(scene());
  ASSERT_EQ(surfaces.size(), 2U);
  EXPECT_EQ(surfaces[0].name, "front");
  EXPECT_EQ(surfaces[1].name, "target");
}

TEST(Conductors, TakeASensorsPlateForTwoTrianglesInTheWorld) {
  const Conductor sensor = conductors(scene())[0];
  ASSERT_EQ(sensor.triangles.size(), 2U);
  EXPECT_EQ(sensor.triangles[0], (Triangle{Vector3d{0, 0, 11}, {1, 0, 11}, {1, 2, 11}}));
  EXPECT_EQ(sensor.triangles[1], (Triangle{Vector3d{0, 0, 11}, {1, 2, 11}, {0, 2, 11}}));
}

TEST(Conductors, PlaceAnObjectByItsOwnPoseAndThenItsLinks) {
  const Conductor object = conductors(scene())[1];
  EXPECT_EQ(object.triangles[0][0], Vector3d(4, -1, 10));
}

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
