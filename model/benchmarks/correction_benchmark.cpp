#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include <benchmark/benchmark.h>
#include <fmt/format.h>
#include <oneapi/tbb/global_control.h>

#include "fringe/live_scene.hpp"
#include "fringe/pose.hpp"
#include "fringe/triangulation.hpp"

/// Measures model, formula and reduced method for an object that moves in front of a sensor, with a new pose
/// for each answer. The counter `per_triangle` is in seconds. Compare methods within one run only.
namespace {

using namespace fringe;

/// Returns the moving objects, from a few large triangles to many small ones.
std::vector<std::pair<std::string, Shape>> shapes() {
  return {{"plate", Plate{0.1, 0.08}},
          {"cuboid", Cuboid{0.1, 0.08, 0.05}},
          {"cylinder", Cylinder{0.05, 0.1, 48}},
          {"sphere", Sphere{0.06, 48}}};
}

void run(benchmark::State& state, const Shape& shape, const Method& method) {
  Scene scene;
  Sensor sensor;
  sensor.name = "sensor";
  sensor.plates = {{{-0.05, -0.05, 0}, {0.1, 0, 0}, {0, 0.1, 0}}};
  scene.sensors = {sensor};
  scene.links = {{"moving", std::nullopt, Eigen::Isometry3d::Identity()}};
  scene.objects = {{"target", 0, shape, Eigen::Isometry3d::Identity(), Grounded{}, true}};
  LiveScene live(scene);
  int step = 0;
  // The object turns and sways 10 to 14 cm above the sensor; no pose is repeated.
  const auto next = [&]() -> double {
    ++step;
    live.set_pose("moving", pose_from_axis({1, 2, 0.5}, 0.37 * step,
                                           {0.03 * std::sin(0.1 * step), 0.02 * std::cos(0.13 * step),
                                            0.12 + 0.02 * std::sin(0.17 * step)}));
    return live.capacitance({.method = method}).sensors.front().total;
  };
  next();
  const auto triangles = static_cast<double>(triangulate(shape).size());
  for ([[maybe_unused]] auto one : state)
    benchmark::DoNotOptimize(next());
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
    for (const Method& method : {Method(Exact{}), Method(Formula{}), Method(Reduced{})})
      benchmark::RegisterBenchmark(fmt::format("{}/{}", name, to_string(method)).c_str(), run, shape, method)
          ->MinTime(0.05);
  benchmark::RunSpecifiedBenchmarks();
}
