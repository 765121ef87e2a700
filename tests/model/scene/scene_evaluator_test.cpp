#include "scene/scene_evaluator.hpp"

#include <limits>
#include <string>

#include <gmock/gmock.h>

#include "fringe/error.hpp"
#include "fringe/pose.hpp"
#include "fringe/scene_info.hpp"
#include "geometry.hpp"
#include "scenes.hpp"

namespace fringe::FRINGE_TEST_FILE {
namespace {

using Eigen::Vector3d;
using test::at;
using test::Random;
using testing::HasSubstr;
using testing::ThrowsMessage;

Object sphere_at(const std::string& name, double radius, const Vector3d& centre) {
  return test::object(name, Sphere{radius, 40}, centre);
}

Sensor plate_sensor(const std::string& name, const Vector3d& corner) {
  return test::sensor(name, {{corner, {0.1, 0, 0}, {0, 0.1, 0}}});
}

/// Returns a scene with a sensor on an arm and one on the wall, a body held by the arm, one on the floor, and
/// many distant ones.
Scene workshop() {
  Scene scene;
  scene.links = {{"arm", std::nullopt, at(0, 0, 0)}, {"hand", 0, at(0, 0, 0.1)}};
  scene.sensors = {test::on_link(0, plate_sensor("on the arm", {-0.05, -0.05, 0.2})),
                   plate_sensor("on the wall", {0.5, 0, 0})};
  scene.objects = {test::on_link(1, sphere_at("held", 0.03, {0, 0, 0.4})),
                   sphere_at("on the floor", 0.1, {0.1, 0.1, 0.5})};
  Random random(1);
  for (int i = 0; i < 20; ++i)
    scene.objects.push_back(
        sphere_at("far " + std::to_string(i), 0.05, random.in_box({-9, -9, 3}, {9, 9, 5})));
  return scene;
}

/// Checks that every value agrees with the exact one within its bound, and that the summed bounds of a sensor
/// are within the tolerance.
void expect_within_bounds(const SceneCapacitance& answer, const SceneCapacitance& exact, double tolerance) {
  for (std::size_t s = 0; s < exact.sensors.size(); ++s) {
    const SensorCapacitance &felt = answer.sensors[s], &true_one = exact.sensors[s];
    double bounds = 0;
    for (std::size_t o = 0; o < true_one.objects.size(); ++o) {
      const ObjectCapacitance& share = felt.objects[o];
      bounds += share.bound;
      EXPECT_NEAR(share.capacitance, true_one.objects[o].capacitance,
                  share.bound + 1e-13 * true_one.objects[o].capacitance)
          << felt.name << ", " << share.name;
    }
    EXPECT_LE(bounds, tolerance * true_one.total * (1 + 1e-12)) << felt.name;
  }
}

TEST(SceneEvaluator, AgreesWithFreshAnswersWhileLinksMove) {
  for (const double tolerance : {0.0, 1e-3, 1e-6}) {
    Scene scene = workshop();
    SceneEvaluator evaluator(scene, {.tolerance = tolerance});
    Random random(2);
    for (int step = 0; step < 6; ++step) {
      expect_within_bounds(evaluator.capacitance(), capacitance(scene), tolerance);
      const std::string link = step % 2 == 0 ? "arm" : "hand";
      const Eigen::Isometry3d pose = pose_from_axis(random.in_box({-1, -1, -1}, {1, 1, 1}), 30,
                                                    random.in_box({-0.1, -0.1, 0}, {0.1, 0.1, 0.1}));
      set_pose(scene, link, pose);
      evaluator.set_pose(link, pose);
    }
  }
}

TEST(SceneEvaluator, EvaluatesOnlyPairsThatMovedRelativeToEachOther) {
  Scene scene = workshop();
  scene.objects.resize(2);
  SceneEvaluator evaluator(scene);
  EXPECT_EQ(evaluator.capacitance().counts.objects_evaluated, 4);
  // Nothing moved.
  EXPECT_EQ(evaluator.capacitance().counts.objects_reused, 4);
  EXPECT_EQ(evaluator.capacitance().counts.triangles_evaluated, 0);
  // The hand carries one body and no sensor.
  evaluator.set_pose("hand", at(0, 0, 0.12));
  EXPECT_EQ(evaluator.capacitance().counts.objects_evaluated, 2);
  // The arm carries a sensor and, through the hand, a body. Their relative pose does not change, nor does
  // that of the sensor and the body that are not attached to the arm.
  evaluator.set_pose("arm", at(0.01, 0, 0));
  const EvaluationCounts counts = evaluator.capacitance().counts;
  EXPECT_EQ(counts.objects_evaluated, 2);
  EXPECT_EQ(counts.objects_reused, 2);
}

TEST(SceneEvaluator, LooksAtFarObjectsFromOutsideOnly) {
  SceneEvaluator evaluator(workshop(), {.tolerance = 1e-2});
  const SceneCapacitance& answer = evaluator.capacitance();
  EXPECT_GE(answer.counts.objects_skipped, 30);
  EXPECT_GT(answer.counts.objects_evaluated, 0);
  const ObjectCapacitance& far = answer.sensors[0].objects[5];
  EXPECT_TRUE(far.skipped);
  EXPECT_GT(far.bound, 0);
}

TEST(SceneEvaluator, CountsEveryTriangleOnce) {
  const Scene scene = workshop();
  std::size_t triangles = 0;
  for (const ObjectInfo& object : scene_info(scene).objects)
    triangles += object.triangles;
  SceneEvaluator evaluator(scene, {.tolerance = 1e-4});
  for (int step = 0; step < 3; ++step) {
    const EvaluationCounts& counts = evaluator.capacitance().counts;
    EXPECT_EQ(counts.triangles_evaluated + counts.triangles_lumped + counts.triangles_skipped +
                  counts.triangles_reused,
              2 * triangles);
    EXPECT_EQ(counts.objects_evaluated + counts.objects_skipped + counts.objects_reused,
              2 * scene.objects.size());
    evaluator.set_pose("arm", at(0.01 * step, 0, 0));
  }
}

TEST(SceneEvaluator, ContactIsInfiniteAndEndsWithIt) {
  Scene scene = workshop();
  SceneEvaluator evaluator(scene, {.tolerance = 1e-4});
  EXPECT_FALSE(evaluator.capacitance().sensors[0].contact);
  evaluator.set_pose("hand", at(0, 0, -0.2));
  const SensorCapacitance touched = evaluator.capacitance().sensors[0];
  EXPECT_TRUE(touched.contact);
  EXPECT_EQ(touched.voltage, 0);
  evaluator.set_pose("hand", at(0, 0, 0.1));
  expect_within_bounds(evaluator.capacitance(), capacitance(scene), 1e-4);
}

TEST(SceneEvaluator, RefusesSensorsThatReachTooFarByName) {
  Scene scene;
  scene.sensors = {plate_sensor("front", {0, 0, 0})};
  const double largest = std::numeric_limits<double>::max();
  scene.sensors[0].plates.push_back({{largest, 0, 0}, {largest, 0, 0}, {0, 1, 0}});
  EXPECT_THAT(
      [&] { capacitance(scene); },
      ThrowsMessage<InputError>(HasSubstr("sensor \"front\": plates[1]: the rectangle reaches too far")));
}

TEST(SceneEvaluator, RefusesByTheFormulaWhatHasNoArea) {
  Scene scene;
  scene.sensors = {plate_sensor("front", {0, 0, 0})};
  scene.objects = {sphere_at("ball", 0.1, {0, 0, 1})};
  Mesh line;
  line.triangles = {{Vector3d{0, 0, 1}, {1, 0, 1}, {2, 0, 1}}};
  scene.objects.push_back(test::object("line", line, at(0, 0, 0)));
  EvaluationOptions options;
  EXPECT_EQ(capacitance(scene, options).sensors[0].objects[1].capacitance, 0);
  options.method = Formula{};
  EXPECT_THAT([&] { capacitance(scene, options); },
              ThrowsMessage<InputError>(HasSubstr("object \"line\" has no area")));
  // A skew line to which rounding gives a tiny area is no surface either.
  line.triangles = {{Vector3d{0.75, 0.625, -0.9828350218347341},
                     {-0.002813172363383439, 0.8466380559157967, 0.16192559771162363},
                     {0.6185363701603503, 0.6637046141206855, -0.7829256792941567}}};
  scene.objects[1].shape = line;
  EXPECT_GT(capacitance(scene, EvaluationOptions{}).sensors[0].objects[1].capacitance, 0);
  EXPECT_THAT([&] { capacitance(scene, options); },
              ThrowsMessage<InputError>(HasSubstr("object \"line\" has no area")));
}

}  // namespace
}  // namespace fringe::FRINGE_TEST_FILE
