#include "fringe/conductors.hpp"

#include <gtest/gtest.h>

#include "fringe/reading.hpp"
#include "scenes.hpp"

namespace fringe::FRINGE_TEST_FILE {
namespace {

using Eigen::Vector3d;

Scene scene() {
  Scene scene;
  scene.links = {{"table", std::nullopt, test::at(0, 0, 10)}};
  scene.objects = {test::on_link(0, test::object("target", Plate{2, 2}, test::at(5, 0, 0)))};
  scene.sensors = {test::on_link(0, test::sensor("front", {{{0, 0, 1}, {1, 0, 0}, {0, 2, 0}}}))};
  return scene;
}

TEST(Conductors, AreSensorsAndThenObjectsAsTrianglesInTheWorld) {
  const std::vector<Conductor> surfaces = conductors(scene());
  ASSERT_EQ(surfaces.size(), 2U);
  EXPECT_EQ(surfaces[0].name, "front");
  EXPECT_EQ(surfaces[0].triangles, (std::vector<Triangle>{{Vector3d{0, 0, 11}, {1, 0, 11}, {1, 2, 11}},
                                                          {Vector3d{0, 0, 11}, {1, 2, 11}, {0, 2, 11}}}));
  EXPECT_EQ(surfaces[1].name, "target");
  // The triangle is moved by its own pose first, then by that of its link.
  EXPECT_EQ(surfaces[1].triangles[0][0], Vector3d(4, -1, 10));
}

Scene machine() {
  Scene scene;
  scene.sensors = {test::sensor("front", {}), test::sensor("back", {})};
  const Cuboid cube{1, 1, 1};
  const Eigen::Isometry3d here = Eigen::Isometry3d::Identity();
  scene.objects = {test::object("hand", cube, here, Floating{}),
                   test::object("guard", cube, here, Electrode{}),
                   test::object("glass", cube, here, Dielectric{5})};
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

TEST(Targets, AreThoseThatAreMarkedElseAllObjectsButElectrodes) {
  Scene scene = machine();
  EXPECT_EQ(targets(scene), (std::vector<bool>{true, false, true}));
  scene.objects[2].target = true;
  EXPECT_EQ(targets(scene), (std::vector<bool>{false, false, true}));
}

}  // namespace
}  // namespace fringe::FRINGE_TEST_FILE
