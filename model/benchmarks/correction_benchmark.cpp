#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include <benchmark/benchmark.h>
#include <fmt/format.h>
#include <oneapi/tbb/global_control.h>

#include "fringe/correction.hpp"
#include "fringe/pose.hpp"
#include "fringe/scene_evaluator.hpp"

/// Measures every correction for an object that moves in front of a sensor, with a new pose for each answer.
/// The counter `per_triangle` is in seconds. Compare corrections within one run only.
namespace {

using namespace fringe;

/// Returns the moving objects, from a few large triangles to many small ones.
std::vector<std::pair<std::string, Shape>> shapes() {
  return {{"plate", Plate{0.1, 0.08}},
          {"cuboid", Cuboid{0.1, 0.08, 0.05}},
          {"cylinder", Cylinder{0.05, 0.1, 48}},
          {"sphere", Sphere{0.06, 72}}};
}

void run(benchmark::State& state, const Shape& shape, Correction correction) {
  Scene scene;
  Sensor sensor;
  sensor.name = "sensor";
  sensor.plates = {{{-0.05, -0.05, 0}, {0.1, 0, 0}, {0, 0.1, 0}}};
  scene.sensors = {sensor};
  scene.links = {{"moving", std::nullopt, Eigen::Isometry3d::Identity()}};
  scene.objects = {{"target", 0, shape, Eigen::Isometry3d::Identity(), Grounded{}, true}};
  SceneEvaluator evaluator(scene, {.correction = correction});
  int step = 0;
  // The object turns and sways 10 to 14 cm above the sensor; no pose is repeated.
  const auto next = [&]() -> const SceneCapacitance& {
    ++step;
    evaluator.set_pose("moving", pose_from_axis({1, 2, 0.5}, 0.37 * step,
                                                {0.03 * std::sin(0.1 * step), 0.02 * std::cos(0.13 * step),
                                                 0.12 + 0.02 * std::sin(0.17 * step)}));
    return evaluator.capacitance();
  };
  const auto triangles = static_cast<double>(next().counts.triangles_evaluated);
  for ([[maybe_unused]] auto one : state)
    benchmark::DoNotOptimize(next().sensors.front().total);
  state.counters["triangles"] = triangles;
  state.counters["per_triangle"] = benchmark::Counter(
      triangles, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

}  // namespace

int main(int argument_count, char** arguments) {
  benchmark::Initialize(&argument_count, arguments);
  if (benchmark::ReportUnrecognizedArguments(argument_count, arguments))
    return 2;
  const tbb::global_control one_thread(tbb::global_control::max_allowed_parallelism, 1);
  for (const auto& [name, shape] : shapes())
    for (const CorrectionInfo& info : corrections())
      benchmark::RegisterBenchmark(fmt::format("{}/{}", name, info.name).c_str(), run, shape, info.correction)
          ->MinTime(0.05);
  benchmark::RunSpecifiedBenchmarks();
}
