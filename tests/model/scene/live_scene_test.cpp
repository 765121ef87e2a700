#include "fringe/live_scene.hpp"

#include <cstddef>
#include <functional>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "fringe/boundary_elements.hpp"
#include "fringe/capacitance.hpp"
#include "fringe/error.hpp"
#include "fringe/pose.hpp"
#include "fringe/scene_collision.hpp"
#include "fringe/scene_sensing.hpp"
#include "reduced/reduced_capacitance.hpp"
#include "scene/scene_evaluator.hpp"
#include "scenes.hpp"

/// Checks that no mutable state is shared: threads that evaluate simultaneously get bit-identical results
/// to one thread alone. tests/clean/run threads checks the same with the thread sanitizer.
namespace fringe::FRINGE_TEST_FILE {
namespace {

using Numbers = std::vector<double>;
using test::at;
using test::object;
using Threads = testing::TestWithParam<std::function<Numbers()>>;

/// Returns a sensor with two bodies: one fixed, the other on the link "arm", where a distance sensor sits
/// too.
Scene bench() {
  Scene scene;
  scene.links = {{"arm", {}, at(0, 0, 0.05)}};
  scene.sensors = {test::sensor("sensor", {test::square(0.1, 0)})};
  scene.distance_sensors = {{"eye", 0, {0, 0, -0.02}, {0, 0, -1}, 40, 5}};
  scene.objects = {test::on_link(0, object("hand", Cuboid{0.05, 0.04, 0.03}, at(0, 0, 0))),
                   object("fixed", Plate{0.1, 0.1}, at(0.3, 0, 0))};
  return scene;
}

const Eigen::Isometry3d moved = pose_from_axis({1, 2, 0}, 25, {0.01, 0.02, 0.08});

std::vector<EvaluationOptions> questions() {
  return {{},
          {.method = Split{3}},
          {.tolerance = 1e-3},
          {.method = Formula{}},
          {.method = Reduced{}, .rtol = 1e-3},
          {.method = BoundaryElements{}, .rtol = 1e-2}};
}

TEST(LiveScene, MovedAnswersAsTheSceneAfresh) {
  LiveScene live(bench());
  for (const EvaluationOptions& options : questions())
    live.evaluate(options);
  live.set_pose("arm", moved);
  Scene scene = bench();
  set_pose(scene, "arm", moved);
  for (const EvaluationOptions& options : questions()) {
    const Evaluation &answer = live.evaluate(options), fresh = evaluate(scene, options);
    EXPECT_EQ(answer.answered_by, fresh.answered_by);
    EXPECT_EQ(answer.matrix.has_value(), fresh.matrix.has_value());
    for (std::size_t object = 0; object < 2; ++object) {
      const ObjectCapacitance& felt = answer.capacitance.sensors[0].objects[object];
      const ObjectCapacitance& expected = fresh.capacitance.sensors[0].objects[object];
      EXPECT_NEAR(felt.capacitance / expected.capacitance, 1, 1e-9 + options.tolerance)
          << fresh.answered_by << ' ' << object;
      EXPECT_EQ(felt.answered_by, expected.answered_by);
      EXPECT_EQ(felt.error.has_value(), expected.error.has_value());
    }
  }
}

TEST(LiveScene, IsOneOwnerOfPosesForEveryQuestion) {
  LiveScene live(bench());
  live.evaluate();
  live.collide();
  live.sense();
  live.set_pose("arm", at(0.3, 0, 0));
  EXPECT_EQ(live.scene().links[0].pose.translation().x(), 0.3);
  ASSERT_EQ(live.collide().marked.size(), 1);
  EXPECT_EQ(live.collide().marked[0].status, PairStatus::collision);
  // The eye now looks down on the fixed plate.
  live.set_pose("arm", at(0.3, 0, 0.22));
  EXPECT_NEAR(live.sense()[0].closest.value().distance, 0.2, 1e-12);
  EXPECT_TRUE(live.collide().marked.empty());
}

TEST(LiveScene, EvaluatesOnlyWhatMovedSinceTheSameQuestionWasAnswered) {
  LiveScene live(bench());
  EXPECT_EQ(live.evaluate().capacitance.counts.objects_evaluated, 2);
  EXPECT_EQ(live.evaluate().capacitance.counts.objects_reused, 2);
  live.set_pose("arm", moved);
  // Another question, answered in between, does not make the first one forget the move.
  live.collide();
  live.evaluate({.method = Reduced{}});
  const EvaluationCounts& counts = live.evaluate().capacitance.counts;
  EXPECT_EQ(counts.objects_evaluated, 1);
  EXPECT_EQ(counts.objects_reused, 1);
  EXPECT_EQ(counts.triangles_reused, 2);
  EXPECT_EQ(live.evaluate().capacitance.counts.objects_reused, 2);
}

TEST(LiveScene, TestsOnlyWhatMovedForCollisions) {
  LiveScene live(bench());
  EXPECT_GT(live.collide().tests.broad, 0);
  live.evaluate();
  EXPECT_EQ(live.collide().tests.broad, 0);
}

TEST(LiveScene, AutoFollowsThePosesFromOneMethodToAnother) {
  LiveScene live(bench());
  const EvaluationOptions options{.rtol = 1e-2};
  EXPECT_EQ(live.evaluate(options).matrix.has_value(), true);
  // In contact with the sensor.
  live.set_pose("arm", at(0, 0, 0.015));
  EXPECT_EQ(live.evaluate(options).answered_by, "formula");
  live.set_pose("arm", at(0, 0, 0.05));
  EXPECT_EQ(live.evaluate(options).matrix.has_value(), true);
}

TEST(LiveScene, RefusesAnUnknownLinkAndAnswersOn) {
  LiveScene live(bench());
  EXPECT_THROW(live.set_pose("leg", moved), InputError);
  EXPECT_EQ(live.evaluate().capacitance.sensors.size(), 1);
}

/// Returns a scene with a sensor of one plate and a distance sensor on an arm, and a ball and a box that
/// intersect.
Scene scene() {
  Scene made;
  made.links = {{"arm", {}, at(0, 0, 0)}};
  made.sensors = {test::on_link(0, test::sensor("front", {test::square(0.1, 0)}))};
  made.distance_sensors = {{"eye", 0, {0, 0, 0}, {0, 0, 1}, 40, 1}};
  made.objects = {object("ball", Sphere{0.05, 60}, at(0.02, 0, 0.2)),
                  object("box", Cuboid{0.1, 0.1, 0.02}, pose_from_axis({0, 0, 1}, 10, {0.08, 0, 0.2}))};
  return made;
}

Scene scene_of_boxes() {
  Scene made = scene();
  made.objects.erase(made.objects.begin());
  return made;
}

void add(Numbers& numbers, const SceneCapacitance& answer) {
  for (const SensorCapacitance& sensor : answer.sensors)
    for (const ObjectCapacitance& object : sensor.objects)
      numbers.insert(numbers.end(), {object.capacitance, object.bound});
}

void add(Numbers& numbers, const MaxwellMatrix& matrix) {
  numbers.insert(numbers.end(), matrix.values.data(), matrix.values.data() + matrix.values.size());
  numbers.insert(numbers.end(), matrix.errors.data(), matrix.errors.data() + matrix.errors.size());
}

Numbers integrals() {
  Numbers numbers;
  for (const PlateRule plates : {PlateRule::sum, PlateRule::nearest})
    for (const FaceRule faces : {FaceRule::all, FaceRule::facing})
      add(numbers, capacitance(scene(), {.plates = plates, .faces = faces}));
  for (const Method& method : {Method{Split{2}}, Method{Gauss{3}}})
    add(numbers, capacitance(scene(), {.method = method}));
  SceneEvaluator evaluator(scene(), {.tolerance = 1e-3});
  for (int step = 0; step < 5; ++step) {
    evaluator.set_pose("arm", pose_from_axis({1, 0, 0}, step, {0, 0, 0.01 * step}));
    add(numbers, evaluator.capacitance());
  }
  return numbers;
}

Numbers formula_of_a_box() {
  Numbers numbers;
  add(numbers, capacitance(scene_of_boxes(), {.method = Formula{}}));
  return numbers;
}

Numbers charges() {
  Numbers numbers;
  add(numbers, maxwell(scene_of_boxes(), {.rtol = 0.05}));
  add(numbers, reduced_capacitance(scene_of_boxes(), {.rtol = 1e-3}));
  return numbers;
}

Numbers collisions_and_distances() {
  Numbers numbers;
  for (const ObjectPair& pair : collide(scene()).marked)
    numbers.insert(numbers.end(), {static_cast<double>(pair.a), static_cast<double>(pair.b),
                                   static_cast<double>(pair.status)});
  for (const ConeMethod method : {ConeMethod::field_of_view, ConeMethod::cone_equation})
    for (const DistanceReading& reading : sense(scene(), method))
      numbers.push_back(reading.closest ? reading.closest->distance : -1);
  return numbers;
}

TEST_P(Threads, HaveTheBitsOfOneAlone) {
  constexpr std::size_t count = 4;
  // The threads run first, so that they initialise the shared constants.
  std::vector<Numbers> together(count);
  std::vector<std::jthread> threads;
  threads.reserve(count);
  for (Numbers& numbers : together)
    threads.emplace_back([&numbers] { numbers = GetParam()(); });
  threads.clear();
  const Numbers alone = GetParam()();
  EXPECT_FALSE(alone.empty());
  for (const Numbers& numbers : together)
    EXPECT_EQ(numbers, alone);
}

INSTANTIATE_TEST_SUITE_P(Of, Threads,
                         testing::Values(integrals, formula_of_a_box, charges, collisions_and_distances));

}  // namespace
}  // namespace fringe::FRINGE_TEST_FILE
