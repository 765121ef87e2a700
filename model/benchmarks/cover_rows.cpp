#include "cover_rows.hpp"

#include <cmath>
#include <cstdio>
#include <numbers>
#include <vector>

#include <fmt/format.h>

#include "fringe/live_scene.hpp"
#include "processor_time.hpp"
#include "random.hpp"
#include "reduced/reduced_capacitance.hpp"

namespace fringe::benchmarks {
namespace {

using Eigen::Isometry3d;
using Eigen::Translation3d;

struct Cover {
  double thickness;  ///< m
  double relative_permittivity;
};

constexpr double side = 0.1;           ///< of the sensor, m
constexpr const char* mover = "hand";  ///< the link of the hand

/// Returns a sensor before a hand, a box whose nearest face is at the origin of its link.
Scene bare_scene() {
  constexpr double hand_thickness = 0.03;
  Scene scene;
  scene.links.push_back({mover, {}, Isometry3d(Translation3d(0, 0, side))});
  scene.sensors.push_back(
      {"sensor", {}, 2.5, 5e-12, {{{-side / 2, -side / 2, 0}, {side, 0, 0}, {0, side, 0}}}});
  scene.objects.push_back({"hand", 0, Cuboid{0.12, 0.18, hand_thickness},
                           Isometry3d(Translation3d(0, 0, hand_thickness / 2)), Grounded{}, true});
  // The hand is a target in both scenes, so that the accuracy of its change is asked for with and without a
  // cover.
  scene.objects.back().target = true;
  return scene;
}

Scene covered_scene(const Cover& cover) {
  Scene scene = bare_scene();
  Object layer{"cover",
               {},
               Cuboid{side, side, cover.thickness},
               Isometry3d(Translation3d(0, 0, cover.thickness / 2)),
               Dielectric{cover.relative_permittivity}};
  layer.conductor = "sensor";
  scene.objects.insert(scene.objects.begin(), layer);
  return scene;
}

/// Distances of the hand from a cover in m.
struct Gaps {
  double least;
  double largest;
};

/// Returns a pose of the hand before a cover, shifted and turned about the sensor's normal.
Isometry3d random_pose(Random& random, const Cover& cover, const Gaps& gaps) {
  const double x = random.uniform(-0.04, 0.04), y = random.uniform(-0.04, 0.04);
  const double gap = gaps.least * std::pow(gaps.largest / gaps.least, random.uniform(0, 1));
  Isometry3d pose(Translation3d(x, y, cover.thickness + gap));
  pose.rotate(Eigen::AngleAxisd(random.uniform(0, 2 * std::numbers::pi), Eigen::Vector3d::UnitZ()));
  return pose;
}

Estimate change_by_boundary_elements(const Scene& scene, const Isometry3d& pose) {
  constexpr double truth_rtol = 1e-2;
  LiveScene there(scene);
  there.set_pose(mover, pose);
  return there.evaluate({.method = BoundaryElements{}, .rtol = truth_rtol, .entries = Entries::of_readings})
      .readings[0]
      .change;
}

}  // namespace

void measure_covers(std::size_t poses) {
  ReducedEvaluator uncovered(bare_scene(), {.rtol = 1e-2});
  for (const Cover& cover : {Cover{2e-3, 4}, {0.5e-3, 80}, {10e-3, 3}}) {
    const Scene scene = covered_scene(cover);
    ReducedEvaluator covered(scene, {.rtol = 1e-2});
    const double preparation = seconds_of([&] { covered.maxwell(); });
    fmt::print("cover of {} mm and {}: {:.1f} s to prepare\n", 1e3 * cover.thickness,
               cover.relative_permittivity, preparation);
    for (const Gaps& gaps : {Gaps{0.01, 0.15}, {0.001, 0.02}}) {
      Random random;
      std::vector<double> ratios, times, errors;
      std::size_t within = 0, reached = 0;
      for (std::size_t k = 0; k < poses; ++k) {
        const Isometry3d pose = random_pose(random, cover, gaps);
        const auto microseconds = [&](ReducedEvaluator& evaluator) {
          return 1e6 * least_seconds_of([&] {
                   evaluator.set_pose(mover, pose);
                   evaluator.maxwell();
                 });
        };
        const double without = microseconds(uncovered), with = microseconds(covered);
        times.push_back(with);
        ratios.push_back(with / without);
        const MaxwellMatrix answer = covered.maxwell();
        reached += answer.reached;
        const Estimate known = change_by_boundary_elements(scene, pose), &found = answer.readings[0].change;
        const double error = std::abs(*found.value - *known.value);
        errors.push_back(100 * error / std::abs(*known.value));
        within += error <= *found.error + *known.error;
      }
      fmt::print(
          "  {} poses {} to {} mm before it: ratio to the time without it median {:.2f}, largest {:.2f}; "
          "µs median {:.0f}, longest {:.0f}\n  changes: error % median {:.2f}, "
          "worst {:.2f}; reached {}, within both stated errors {}\n",
          poses, 1e3 * gaps.least, 1e3 * gaps.largest, quantile(ratios, 0.5), quantile(ratios, 1),
          quantile(times, 0.5), quantile(times, 1), quantile(errors, 0.5), quantile(errors, 1), reached,
          within);
      std::fflush(stdout);
    }
  }
}

}  // namespace fringe::benchmarks
