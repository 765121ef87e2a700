#include "fringe/conductors.hpp"

#include <gtest/gtest.h>

#include "fringe/pose.hpp"

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

}  // namespace
}  // namespace fringe::FRINGE_TEST_FILE
