#include <cstddef>
#include <functional>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "fringe/boundary_elements.hpp"
#include "fringe/capacitance.hpp"
#include "fringe/pose.hpp"
#include "fringe/scene_collision.hpp"
#include "fringe/scene_sensing.hpp"
#include "reduced/reduced_capacitance.hpp"
#include "scene/scene_evaluator.hpp"

/// Checks that no mutable state is shared: threads that evaluate simultaneously get bit-identical results to
/// one thread alone. tests/clean/run threads checks the same with the thread sanitizer.
namespace fringe::FRINGE_TEST_FILE {
namespace {

/// Returns a scene with a sensor of one plate and a distance sensor on an arm, and a ball and a box that
/// intersect.
Scene scene() {
  Scene made;
  made.links = {{"arm", std::nullopt, Eigen::Isometry3d::Identity()}};
  Sensor sensor;
  sensor.name = "front";
  sensor.link = 0;
  sensor.plates = {{{-0.05, -0.05, 0}, {0.1, 0, 0}, {0, 0.1, 0}}};
  made.sensors = {sensor};
  made.distance_sensors = {{"eye", 0, {0, 0, 0}, {0, 0, 1}, 40, 1}};
  made.objects = {{"ball", std::nullopt, Sphere{0.05, 60}, pose_from_axis({0, 0, 1}, 0, {0.02, 0, 0.2}),
                   Grounded{}, true},
                  {"box", std::nullopt, Cuboid{0.1, 0.1, 0.02}, pose_from_axis({0, 0, 1}, 10, {0.08, 0, 0.2}),
                   Grounded{}, true}};
  return made;
}

Scene scene_of_boxes() {
  Scene made = scene();
  made.objects.erase(made.objects.begin());
  return made;
}

using Numbers = std::vector<double>;

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

using Threads = testing::TestWithParam<std::function<Numbers()>>;

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
