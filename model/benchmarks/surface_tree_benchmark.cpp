#include <cmath>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include "fringe/pose.hpp"
#include "fringe/surface_tree.hpp"
#include "triangle_sets.hpp"

/// Measures the tree over a closed mesh: building it, and integrating one plate and pose, against tolerance,
/// gap and the mesh's number of triangles. The column `error` is the actual error and `bound` the guaranteed
/// one, both relative to the sum of the triangles' integrals; `evaluated` counts triangles, `nodes` the nodes
/// whose quadrature was used.
namespace {

using namespace fringe;

struct Surface {
  std::vector<Triangle> triangles;
  std::unique_ptr<SurfaceTree> tree;
};

/// Returns the closed mesh of this many segments with its tree; each is made once.
const Surface& surface(int segments) {
  static std::map<int, Surface> made;
  Surface& result = made[segments];
  if (!result.tree) {
    result.triangles = benchmarks::closed_mesh(segments).triangles;
    result.tree = std::make_unique<SurfaceTree>(result.triangles);
  }
  return result;
}

/// Returns the plate of the triangle sets, `gap` metres farther from the mesh and turned about an edge.
Rectangle posed_plate(double gap, double degrees) {
  return transformed(benchmarks::measured_plate(), pose_from_axis({1, 0, 0}, degrees, {0, 0, -gap}));
}

void build(benchmark::State& state, int segments) {
  const std::vector<Triangle>& triangles = surface(segments).triangles;
  for ([[maybe_unused]] auto step : state)
    benchmark::DoNotOptimize(SurfaceTree(triangles));
  state.counters["triangles"] = static_cast<double>(triangles.size());
}

void integrate(benchmark::State& state, int segments, const Rectangle& plate, double tolerance,
               FaceRule faces) {
  const SurfaceTree& tree = *surface(segments).tree;
  TreeIntegral integral;
  for ([[maybe_unused]] auto step : state)
    benchmark::DoNotOptimize(integral = tree.integrate(plate, tolerance, 0, faces));
  const double exact = tree.integrate(plate, 0, 0, faces).value;
  state.counters["triangles"] = static_cast<double>(tree.triangle_count());
  state.counters["error"] = std::abs(integral.value - exact) / exact;
  state.counters["bound"] = integral.bound / exact;
  state.counters["evaluated"] = static_cast<double>(integral.counts.triangles_evaluated);
  state.counters["nodes"] = static_cast<double>(integral.counts.nodes_lumped);
  state.counters["points"] = static_cast<double>(integral.counts.points);
}

/// Segments of a mesh of about a hundred thousand triangles.
constexpr int measured_segments = 318;

void register_builds() {
  for (const int segments : {100, measured_segments, 1000})
    benchmark::RegisterBenchmark(fmt::format("build/{}", segments).c_str(), build, segments)
        ->Unit(benchmark::kMillisecond);
}

void register_integrals(int segments, double gap, double degrees, FaceRule faces) {
  for (const double tolerance : {0.0, 1e-3, 1e-4, 1e-6, 1e-9}) {
    const std::string name = fmt::format("integrate/segments:{}/gap:{}/tilt:{}/{}/tolerance:{}", segments,
                                         gap, degrees, to_string(faces), tolerance);
    benchmark::RegisterBenchmark(name.c_str(), integrate, segments, posed_plate(gap, degrees), tolerance,
                                 faces)
        ->Unit(benchmark::kMicrosecond)
        ->MinTime(0.05);
  }
}

}  // namespace

int main(int argument_count, char** arguments) {
  benchmark::Initialize(&argument_count, arguments);
  register_builds();
  for (const double gap : {0.0, 0.1, 1.0})
    for (const double degrees : {0.0, 30.0})
      register_integrals(measured_segments, gap, degrees, FaceRule::all);
  register_integrals(measured_segments, 0.1, 0, FaceRule::facing);
  // These meshes have a tenth and ten times as many triangles on the same surface.
  for (const int segments : {100, 1000})
    register_integrals(segments, 0.1, 0, FaceRule::all);
  benchmark::RunSpecifiedBenchmarks();
}
