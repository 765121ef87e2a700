#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include "fringe/distance_sensor.hpp"
#include "fringe/pose.hpp"
#include "fringe/triangulation.hpp"
#include "random.hpp"

/// Measures the queries of a distance sensor in a room full of bodies, by the tree and by testing every
/// triangle, and the building of the tree. The sensors stand among the bodies and look in all directions;
/// `seen` is the fraction of queries with an answer.
namespace {

using namespace fringe;
using Eigen::Vector3d;

/// Segments of a sphere of 32·30 triangles.
constexpr int segments = 32;

constexpr std::size_t questions = 256;  ///< number of cones

/// Makes bodies of 10 to 40 cm in a room of 6 m.
std::vector<Triangle> room(int bodies) {
  benchmarks::Random random;
  std::vector<Triangle> triangles;
  for (int i = 0; i < bodies; ++i) {
    const double radius = random.uniform(0.05, 0.2);
    const Eigen::Isometry3d place =
        pose_from_axis(random.in_cube(1), random.uniform(0, 360), random.in_cube(3));
    for (const Triangle& triangle : triangulate(Sphere{radius, segments}))
      triangles.push_back(transformed(triangle, place));
  }
  return triangles;
}

std::vector<SensingCone> cones(double degrees) {
  benchmarks::Random random;
  std::vector<SensingCone> result;
  for (std::size_t i = 0; i < questions; ++i) {
    const Vector3d apex = random.in_cube(2.5), direction = random.in_cube(1);
    result.push_back({apex, direction, degrees / 180 * std::numbers::pi, 2});
  }
  return result;
}

/// Measures one query after another; the time is that of one query.
template <class Answer>
void ask(benchmark::State& state, const std::vector<SensingCone>& asked, std::size_t triangles,
         const Answer& answer) {
  std::size_t count = 0, seen = 0;
  for ([[maybe_unused]] auto step : state)
    seen += answer(asked[count++ % asked.size()]).has_value() ? 1 : 0;
  state.counters["triangles"] = static_cast<double>(triangles);
  state.counters["seen"] = static_cast<double>(seen) / static_cast<double>(count);
}

void by_tree(benchmark::State& state, int bodies, double degrees, ConeMethod method) {
  const std::vector<Triangle> triangles = room(bodies);
  const SensedSurface surface(triangles);
  ask(state, cones(degrees), triangles.size(),
      [&](const SensingCone& cone) { return surface.closest(cone, method); });
}

void by_looking_at_all(benchmark::State& state, int bodies, double degrees) {
  const std::vector<Triangle> triangles = room(bodies);
  ask(state, cones(degrees), triangles.size(),
      [&](const SensingCone& cone) { return cone_closest(triangles, cone); });
}

void build(benchmark::State& state, int bodies) {
  const std::vector<Triangle> triangles = room(bodies);
  for ([[maybe_unused]] auto step : state)
    benchmark::DoNotOptimize(SensedSurface(triangles));
  state.counters["triangles"] = static_cast<double>(triangles.size());
}

void one_triangle(benchmark::State& state, ConeMethod method) {
  const std::vector<Triangle> triangle{{{{6, -9, 0}, {6, 9, 0}, {-8, 0, 7}}}};
  const SensingCone cone{Vector3d::Zero(), {0, 0, 1}, 2 * std::atan(0.25), 10};
  for ([[maybe_unused]] auto step : state)
    benchmark::DoNotOptimize(cone_closest(triangle, cone, method));
}

}  // namespace

int main(int argument_count, char** arguments) {
  benchmark::Initialize(&argument_count, arguments);
  if (benchmark::ReportUnrecognizedArguments(argument_count, arguments))
    return 2;
  for (const auto& [name, method] : {std::pair("field_of_view", ConeMethod::field_of_view),
                                     std::pair("cone_equation", ConeMethod::cone_equation)})
    benchmark::RegisterBenchmark(fmt::format("one_triangle/{}", name).c_str(), one_triangle, method);
  // 104 bodies have about a hundred thousand triangles.
  for (const int bodies : {10, 104, 1040}) {
    benchmark::RegisterBenchmark(fmt::format("build/bodies:{}", bodies).c_str(), build, bodies)
        ->Unit(benchmark::kMillisecond);
    for (const double degrees : {20.0, 60.0, 180.0}) {
      const std::string what = fmt::format("bodies:{}/degrees:{}", bodies, degrees);
      benchmark::RegisterBenchmark(("tree/" + what).c_str(), by_tree, bodies, degrees,
                                   ConeMethod::field_of_view)
          ->Unit(benchmark::kMicrosecond);
      benchmark::RegisterBenchmark(("every_triangle/" + what).c_str(), by_looking_at_all, bodies, degrees)
          ->Unit(benchmark::kMicrosecond);
    }
  }
  benchmark::RunSpecifiedBenchmarks();
}
