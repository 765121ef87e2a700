#include "fringe/scene_sensing.hpp"

#include <numbers>

#include <gtest/gtest.h>

#include "fringe/conductors.hpp"
#include "fringe/error.hpp"
#include "fringe/pose.hpp"
#include "geometry.hpp"
#include "scenes.hpp"

namespace fringe::FRINGE_TEST_FILE {
namespace {

using Eigen::Vector3d;
using test::at;

/// Returns a scene with an arm whose sensor looks along x at a cube 1 m away, past a sphere beside its cone.
Scene arm_and_cube() {
  Scene scene;
  scene.links = {{"arm", std::nullopt, at(0, 0, 0.5)}};
  scene.distance_sensors = {{"eye", 0, {0.1, 0, 0}, {3, 0, 0}, 40, 2}};
  scene.objects.push_back({"ball", std::nullopt, Sphere{0.1, 12}, at(0.3, 0.5, 0.5)});
  scene.objects.push_back({"cube", std::nullopt, Cuboid{0.2, 0.2, 0.2}, at(1.2, 0, 0.5), Floating{}, false});
  return scene;
}

TEST(SceneSensing, NamesTheObjectAndThePointInTheWorld) {
  const std::vector<DistanceReading> readings = sense(arm_and_cube());
  ASSERT_EQ(readings.size(), 1U);
  EXPECT_EQ(readings[0].name, "eye");
  ASSERT_TRUE(readings[0].closest);
  EXPECT_EQ(readings[0].closest->object, "cube");
  EXPECT_NEAR(readings[0].closest->distance, 1, 1e-15);
  EXPECT_LE((readings[0].closest->point - Vector3d(1.1, 0, 0.5)).norm(), 1e-15);
  const Triangle seen = conductors(arm_and_cube())[1].triangles[readings[0].closest->triangle];
  for (const Vector3d& vertex : seen)
    EXPECT_NEAR(vertex.x(), 1.1, 1e-15);
}

TEST(SceneSensing, SeesNothingWhereNothingIs) {
  Scene scene = arm_and_cube();
  scene.distance_sensors[0].direction = {0, 0, 1};
  EXPECT_FALSE(sense(scene)[0].closest);
  scene = arm_and_cube();
  scene.distance_sensors[0].range = 0.999;
  EXPECT_FALSE(sense(scene)[0].closest);
}

TEST(SceneSensing, FollowsTheLinks) {
  Scene scene = arm_and_cube();
  SceneSensing sensing(scene);
  test::Random random(1);
  int seen = 0;
  for (int i = 0; i < 200; ++i) {
    Eigen::Isometry3d pose = random.rigid_motion();
    pose.translation() *= 0.3;
    sensing.set_pose("arm", pose);
    set_pose(scene, "arm", pose);
    const DistanceReading reading = sensing.sense()[0];
    // The expected result comes from every triangle of every object.
    const SensingCone cone{pose * scene.distance_sensors[0].apex, pose.linear() * Vector3d(1, 0, 0),
                           40. / 180 * std::numbers::pi, 2};
    std::optional<VisiblePoint> expected;
    std::string object;
    for (const auto& [name, triangles] : conductors(scene)) {
      const auto closest = cone_closest(triangles, cone);
      if (closest && (!expected || closest->distance < expected->distance)) {
        expected = closest;
        object = name;
      }
    }
    ASSERT_EQ(reading.closest.has_value(), expected.has_value());
    if (!expected)
      continue;
    ++seen;
    EXPECT_EQ(reading.closest->distance, expected->distance);
    EXPECT_EQ(reading.closest->point, expected->point);
    EXPECT_EQ(reading.closest->object, object);
    EXPECT_EQ(reading.closest->triangle, expected->triangle);
  }
  EXPECT_GE(seen, 20);
}

TEST(SceneSensing, LooksAsFarToTheSideAsHalfASphere) {
  Scene scene = arm_and_cube();
  scene.distance_sensors[0].full_angle_degrees = 180;
  scene.objects = {{"post", std::nullopt, Cuboid{0.2, 0.2, 0.2}, at(0.0, 1.1, 0.5)}};
  const auto closest = sense(scene)[0].closest;
  ASSERT_TRUE(closest);
  // The side of the post that just reaches into the half sphere at its boundary plane.
  EXPECT_NEAR(closest->distance, 1, 1e-12);
}

TEST(SceneSensing, SaysWhatIsWrong) {
  SceneSensing sensing(arm_and_cube());
  EXPECT_THROW(sensing.set_pose("leg", Eigen::Isometry3d::Identity()), InputError);
  sensing.set_pose("arm", at(1e308, 0, 0));
  EXPECT_FALSE(sensing.sense()[0].closest);
  Scene scene = arm_and_cube();
  scene.distance_sensors[0].apex.x() = 1e308;
  scene.links[0].pose = at(1e308, 0, 0);
  EXPECT_THROW(sense(scene), InputError);
}

}  // namespace
}  // namespace fringe::FRINGE_TEST_FILE
