#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include "fringe/plate_integral.hpp"
#include "fringe/triangulation.hpp"

/// Time per triangle of every method, in one run, on the sets of triangles that decide how fast a scene is.
/// The column `error` is the largest relative error against the exact method.
namespace {

using namespace fringe;
using Eigen::Vector3d;

const Rectangle plate{{0, 0, 0}, {0.1, 0, 0}, {0, 0.1, 0}};

/// A triangle of the given size about a point, turned at random.
Triangle small_triangle(std::mt19937_64& generator, const Vector3d& centre, double size) {
  std::normal_distribution<double> normal;
  const auto corner = [&]() -> Vector3d {
    return centre + size * Vector3d(normal(generator), normal(generator), normal(generator)).normalized();
  };
  return {corner(), corner(), corner()};
}

/// Triangles whose size is a fixed share of their distance from the plate, all in the box from `low` to
/// `high`.
std::vector<Triangle> triangles_in_box(const Vector3d& low, const Vector3d& high, double size_over_distance) {
  constexpr int count = 2000;
  std::mt19937_64 generator(1);
  std::uniform_real_distribution<double> uniform;
  std::vector<Triangle> triangles;
  for (int i = 0; i < count; ++i) {
    const Vector3d share(uniform(generator), uniform(generator), uniform(generator));
    const Vector3d centre = low + share.cwiseProduct(high - low);
    const double x = centre.x() - std::clamp(centre.x(), 0.0, 0.1),
                 y = centre.y() - std::clamp(centre.y(), 0.0, 0.1);
    triangles.push_back(small_triangle(generator, centre, size_over_distance * std::hypot(x, y, centre.z())));
  }
  return triangles;
}

/// A closed mesh of 100,352 triangles in front of the plate and larger than it, so that all nine cells are
/// met.
std::vector<Triangle> ellipsoid() {
  std::vector<Triangle> triangles = triangulate(Sphere{1, 448});
  const Vector3d half_axes(0.15, 0.1, 0.08), centre(0.06, 0.04, 0.13);
  for (Triangle& triangle : triangles)
    for (Vector3d& vertex : triangle)
      vertex = centre + half_axes.cwiseProduct(vertex);
  return triangles;
}

using TriangleSets = std::map<std::string, std::vector<Triangle>>;

TriangleSets triangle_sets() {
  constexpr double fine = 0.02, coarse = 0.3;
  TriangleSets sets;
  for (const auto& [name, ratio] : {std::pair{"fine", fine}, std::pair{"coarse", coarse}}) {
    sets[fmt::format("I_{}", name)] = triangles_in_box({0.04, 0.04, 0.02}, {0.06, 0.06, 0.1}, ratio);
    sets[fmt::format("II_{}", name)] = triangles_in_box({-0.2, 0.045, 0.02}, {-0.1, 0.055, 0.1}, ratio);
    sets[fmt::format("III_{}", name)] = triangles_in_box({-0.2, -0.2, 0.02}, {-0.1, -0.1, 0.1}, ratio);
  }
  sets["straddling_nine_cells"] = triangles_in_box({0.03, 0.03, 0.1}, {0.07, 0.07, 0.2}, 2);
  sets["ellipsoid_100k"] = ellipsoid();
  return sets;
}

double largest_relative_error(const std::vector<double>& values, const std::vector<double>& exact) {
  double largest = 0;
  for (std::size_t i = 0; i < values.size(); ++i)
    if (std::isfinite(exact[i]) && exact[i] > 0)
      largest = std::max(largest, std::abs(values[i] - exact[i]) / exact[i]);
  return largest;
}

void run(benchmark::State& state, const std::vector<Triangle>& triangles, const Method& method) {
  std::vector<double> values;
  for ([[maybe_unused]] auto step : state)
    benchmark::DoNotOptimize(values = plate_integrals(triangles, plate, method));
  const auto count = static_cast<double>(triangles.size());
  state.counters["per_triangle"] =
      benchmark::Counter(count, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
  state.counters["error"] = largest_relative_error(values, plate_integrals(triangles, plate));
}

}  // namespace

int main(int argument_count, char** arguments) {
  benchmark::Initialize(&argument_count, arguments);
  std::vector<std::string> methods{"exact"};
  for (int levels = 0; levels <= 8; ++levels)
    methods.push_back(fmt::format("split:{}", levels));
  for (const int points : {1, 2, 4, 8, 16})
    methods.push_back(fmt::format("gauss:{}", points));

  const TriangleSets sets = triangle_sets();
  for (const auto& [name, triangles] : sets)
    for (const std::string& method : methods)
      benchmark::RegisterBenchmark(fmt::format("{}/{}", name, method).c_str(), run, triangles,
                                   parse_method(method))
          ->Unit(benchmark::kMillisecond)
          ->MinTime(0.05);
  benchmark::RunSpecifiedBenchmarks();
}
