#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include <benchmark/benchmark.h>
#include <fmt/format.h>
#include <oneapi/tbb/global_control.h>

#include "fringe/pose.hpp"
#include "random.hpp"
#include "scene/scene_evaluator.hpp"

/// Measures the time of a pose in a scene whose arm moves: eight sensors on the arm, some bodies near it,
/// many more in the room. The time depends on the bodies nearby, not on their total number. Counters are per
/// pose and summed over the sensors; `bound` is the largest bound of a sensor relative to its total, `error`
/// the largest actual error, at the last pose.
namespace {

using namespace fringe;
using Eigen::Vector3d;

/// Segments of a sphere of 72·70 triangles; 200 spheres have a million.
constexpr int segments = 72;

constexpr int near_bodies = 8;

Eigen::Isometry3d shifted(const Vector3d& translation) {
  return pose_from_axis({0, 0, 1}, 0, translation);
}

/// Returns eight plates around the tip of an arm that is 1 m long.
std::vector<Sensor> sensors_on_arm() {
  std::vector<Sensor> sensors;
  for (int i = 0; i < 8; ++i) {
    const Eigen::Isometry3d around =
        pose_from_axis({1, 0, 0}, 90.0 * (i % 4), {0, 0, 0}) * shifted({i < 4 ? 0.7 : 0.9, -0.05, 0.1});
    Sensor sensor;
    sensor.name = fmt::format("sensor {}", i);
    sensor.link = 0;
    sensor.plates = {transformed(Rectangle{{0, 0, 0}, {0.1, 0, 0}, {0, 0.1, 0}}, around)};
    sensors.push_back(sensor);
  }
  return sensors;
}

/// Makes a room of 10 m with the arm in its middle: bodies of 10 to 40 cm, the first few around the arm, the
/// others at least 2 m away.
Scene room(int bodies) {
  benchmarks::Random random;
  Scene scene;
  scene.links = {{"arm", std::nullopt, shifted({0, 0, 0})}};
  scene.sensors = sensors_on_arm();
  for (int i = 0; i < bodies; ++i) {
    const double angle = 2 * std::numbers::pi * random.uniform(0, 1);
    const double distance = i < near_bodies ? random.uniform(1.5, 1.9) : random.uniform(2, 5);
    const Vector3d centre(distance * std::cos(angle), distance * std::sin(angle), random.uniform(-1, 1));
    scene.objects.push_back({fmt::format("body {}", i), std::nullopt,
                             Sphere{random.uniform(0.05, 0.2), segments}, shifted(centre), Grounded{}, true});
  }
  return scene;
}

/// Returns the arm's pose: it turns about the vertical axis and nods.
Eigen::Isometry3d arm_pose(int step) {
  return pose_from_axis({0, 0, 1}, 0.5 * step, {0, 0, 0}) *
         pose_from_axis({0, 1, 0}, 20 * std::sin(0.02 * step), {0, 0, 0});
}

double largest_bound(const SceneCapacitance& answer) {
  double largest = 0;
  for (const SensorCapacitance& sensor : answer.sensors) {
    double bound = 0;
    for (const ObjectCapacitance& object : sensor.objects)
      bound += object.bound;
    largest = std::max(largest, bound / sensor.total);
  }
  return largest;
}

double largest_error(const SceneCapacitance& answer, const SceneCapacitance& exact) {
  double largest = 0;
  for (std::size_t i = 0; i < exact.sensors.size(); ++i)
    largest = std::max(largest,
                       std::abs(answer.sensors[i].total - exact.sensors[i].total) / exact.sensors[i].total);
  return largest;
}

void run(benchmark::State& state, int bodies, double tolerance) {
  Scene scene = room(bodies);
  SceneEvaluator evaluator(scene, {.tolerance = tolerance});
  int step = 0;
  const auto move = [&]() -> const SceneCapacitance& {
    evaluator.set_pose("arm", arm_pose(++step));
    return evaluator.capacitance();
  };
  // This first round builds the trees before the measurement.
  for (int i = 0; i < 720; ++i)
    move();
  EvaluationCounts counts;
  for ([[maybe_unused]] auto one : state)
    counts += move().counts;
  const auto per_pose = [&](std::size_t count) {
    return benchmark::Counter(static_cast<double>(count), benchmark::Counter::kAvgIterations);
  };
  state.counters["triangles"] = static_cast<double>(bodies) * segments * (segments - 2);
  state.counters["evaluated"] = per_pose(counts.triangles_evaluated);
  state.counters["lumped"] = per_pose(counts.triangles_lumped);
  state.counters["nodes"] = per_pose(counts.nodes_lumped);
  state.counters["objects_evaluated"] = per_pose(counts.objects_evaluated);
  state.counters["objects_skipped"] = per_pose(counts.objects_skipped);
  const SceneCapacitance& answer = move();
  set_pose(scene, "arm", arm_pose(step));
  state.counters["bound"] = largest_bound(answer);
  state.counters["error"] = largest_error(answer, capacitance(scene));
}

}  // namespace

int main(int argument_count, char** arguments) {
  benchmark::Initialize(&argument_count, arguments);
  if (benchmark::ReportUnrecognizedArguments(argument_count, arguments))
    return 2;
  const tbb::global_control one_thread(tbb::global_control::max_allowed_parallelism, 1);
  for (const int bodies : {25, 50, 100, 200})
    for (const double tolerance : {1e-2, 1e-4})
      benchmark::RegisterBenchmark(fmt::format("pose/bodies:{}/tolerance:{}", bodies, tolerance).c_str(), run,
                                   bodies, tolerance)
          ->Unit(benchmark::kMicrosecond);
  benchmark::RunSpecifiedBenchmarks();
}
