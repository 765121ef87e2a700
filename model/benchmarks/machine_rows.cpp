#include "machine_rows.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <limits>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "fringe/live_scene.hpp"
#include "fringe/motion.hpp"
#include "fringe/pose.hpp"
#include "fringe/scene.hpp"
#include "fringe/scene_reader.hpp"
#include "fringe/triangulation.hpp"
#include "processor_time.hpp"

namespace fringe::benchmarks {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

/// Height of the sensors on top of the forearm, m.
constexpr double top = -0.001;

Isometry3d at(const Vector3d& place) {
  return Isometry3d(Eigen::Translation3d(place));
}

Isometry3d along_x(const Vector3d& place) {
  return at(place) * Eigen::AngleAxisd(std::numbers::pi / 2, Vector3d::UnitY());
}

void add(Mesh& mesh, const Shape& shape, const Isometry3d& pose) {
  for (const Triangle& triangle : triangulate(shape))
    mesh.triangles.push_back({pose * triangle[0], pose * triangle[1], pose * triangle[2]});
}

/// Returns a palm, four fingers and a thumb, which overlap.
Mesh hand() {
  Mesh mesh{{}, 1, {}};
  constexpr int segments = 20;
  add(mesh, RoundedCuboid{0.09, 0.1, 0.028, 0.012, segments}, at({0, 0, 0}));
  for (int finger = 0; finger < 4; ++finger)
    add(mesh, Capsule{0.009, 0.08, segments},
        at({-0.033 + 0.022 * finger, 0.075, -0.002 * finger}) *
            Eigen::AngleAxisd(std::numbers::pi / 2, Vector3d::UnitX()));
  add(mesh, Capsule{0.011, 0.06, segments},
      at({0.055, -0.005, 0}) * Eigen::AngleAxisd(std::numbers::pi / 3, Vector3d::UnitY()));
  return mesh;
}

}  // namespace

Scene hand_before_arm() {
  constexpr int segments = 32;
  Scene scene;
  scene.links = {{"arm", {}, Isometry3d::Identity()}, {"hand", {}, Isometry3d::Identity()}};
  const auto add_part = [&](const std::string& name, const Shape& shape, const Isometry3d& pose) {
    scene.objects.push_back({name, 0, shape, pose, Grounded{}, true});
  };
  add_part("foot", Cylinder{0.09, 0.1, segments}, at({-0.45, 0, -0.75}));
  add_part("column", Capsule{0.07, 0.5, segments}, at({-0.45, 0, -0.45}));
  add_part("shoulder", Sphere{0.085, segments}, at({-0.45, 0, -0.12}));
  add_part("upper arm", Capsule{0.06, 0.35, segments}, along_x({-0.25, 0, -0.1}));
  add_part("elbow", Sphere{0.07, segments}, at({-0.05, 0, -0.09}));
  add_part("forearm", Cuboid{0.34, 0.1, 0.1}, at({0.13, 0, -0.055}));
  add_part("wrist", Capsule{0.045, 0.12, segments}, along_x({0.33, 0, -0.055}));
  add_part("tool", Cylinder{0.04, 0.1, segments}, along_x({0.44, 0, -0.055}));
  const auto add_sensor = [&](const std::string& name, const Vector3d& corner, const Vector3d& u,
                              const Vector3d& v) {
    Sensor sensor;
    sensor.name = name;
    sensor.link = 0;
    sensor.plates = {{corner, u, v}};
    scene.sensors.push_back(sensor);
  };
  for (int k = 0; k < 3; ++k)
    add_sensor("top " + std::to_string(k), {-0.03 + 0.115 * k, -0.045, top}, {0.1, 0, 0}, {0, 0.09, 0});
  for (int k = 0; k < 2; ++k)
    for (const auto& [side, y] : {std::pair("left ", 0.054), std::pair("right ", -0.054)})
      add_sensor(side + std::to_string(k), {0.15 * k, y, -0.1}, {0.12, 0, 0}, {0, 0, 0.09});
  add_sensor("below", {0.03, -0.045, -0.109}, {0.2, 0, 0}, {0, 0.09, 0});
  scene.objects.push_back({"hand", 1, hand(), Isometry3d::Identity(), Grounded{}, true});
  scene.objects.back().target = true;
  return scene;
}

std::vector<Frame> hand_poses(const Scene& scene, std::size_t count) {
  constexpr double farthest = 0.3, nearest = 0.02;
  std::vector<Frame> motion;
  for (std::size_t k = 0; k < count; ++k) {
    const double part = static_cast<double>(k) / static_cast<double>(count - 1),
                 turn = std::numbers::pi * part;
    Isometry3d pose = Isometry3d::Identity();
    pose.rotate(Eigen::AngleAxisd(std::sin(5 * turn), Vector3d::UnitZ()))
        .rotate(Eigen::AngleAxisd(0.25 * std::sin(9 * turn), Vector3d::UnitX()));
    double lowest = std::numeric_limits<double>::infinity();
    for (const Triangle& triangle : triangulate(scene.objects.back().shape))
      for (const Vector3d& corner : triangle)
        lowest = std::min(lowest, (pose * corner).z());
    const double gap = farthest * std::pow(nearest / farthest, part);
    pose.pretranslate(
        Vector3d(0.12 + 0.15 * std::sin(7 * turn), 0.03 * std::sin(11 * turn), top + gap - lowest));
    motion.push_back({std::to_string(k + 1), {Isometry3d::Identity(), pose}});
  }
  return motion;
}

std::size_t triangles_of(const Scene& scene, bool of_targets) {
  std::size_t count = 0;
  for (const Object& object : scene.objects)
    if (object.target == of_targets)
      count += triangulate(object.shape).size();
  return count;
}

void measure_hand_before_arm(std::size_t compared) {
  constexpr std::size_t poses = 500;
  constexpr double truth_rtol = 1e-2;
  const Scene scene = hand_before_arm();
  const std::vector<Frame> motion = hand_poses(scene, poses);
  for (const double rtol : {1e-1, 5e-2, 1e-2}) {
    LiveScene live(scene);
    const EvaluationOptions options{.method = Reduced{}, .rtol = rtol};
    std::vector<std::vector<ReadingAnswer>> answers;
    const double first = seconds_of([&] { live.readings_of(motion, options, 1); });
    const double again = seconds_of([&] { answers = live.readings_of(motion, options, 1); });
    fmt::print("hand of {} triangles before an arm of {} with {} sensors, rtol {}: {} poses, {:.2f} ms each, "
               "{:.1f} s to prepare\n",
               triangles_of(scene, true), triangles_of(scene, false), scene.sensors.size(), rtol, poses,
               1e3 * again / poses, first - again);
    std::fflush(stdout);
    std::vector<double> errors;
    double squares = 0, stated = 0, ratio = 0;
    std::size_t covered = 0;
    for (std::size_t k = 0; k < compared; ++k) {
      const std::size_t pose = (k + 1) * poses / compared - 1;
      LiveScene there(scene);
      there.set_poses(motion[pose].poses);
      const Evaluation truth = there.evaluate({.method = BoundaryElements{}, .rtol = truth_rtol});
      for (std::size_t reading = 0; reading < truth.readings.size(); ++reading) {
        const Estimate &known = truth.readings[reading].change, &found = answers[pose][reading].change;
        const double error = std::abs(*found.value - *known.value);
        errors.push_back(100 * error / std::abs(*known.value));
        squares += errors.back() * errors.back();
        stated += 100 * *found.error / std::abs(*known.value);
        covered += error <= *found.error + *known.error;
        ratio = std::max(ratio, error / *found.error);
      }
    }
    if (!errors.empty())
      fmt::print("  {} changes: rms {:.2f} %, median {:.2f} %, worst {:.2f} %; stated in the mean {:.2f} %; "
                 "covered {}, largest difference per stated error {:.2f}\n",
                 errors.size(), std::sqrt(squares / static_cast<double>(errors.size())),
                 quantile(errors, 0.5), quantile(errors, 1), stated / static_cast<double>(errors.size()),
                 covered, ratio);
  }
}

void measure_motion(const std::filesystem::path& file, std::size_t poses,
                    const std::optional<std::string>& folder) {
  constexpr double rtol = 1e-2;
  const Scene scene = load_scene(file);
  std::vector<Frame> motion =
      load_motion(std::filesystem::path(file).replace_extension(".motion.toml"), scene);
  motion.resize(std::min(poses, motion.size()));
  EvaluationOptions options{.method = Reduced{}, .rtol = rtol};
  const auto report = [&](const std::string& how) {
    LiveScene live(scene);
    std::vector<std::vector<ReadingAnswer>> answers;
    const double first = seconds_of([&] { live.readings_of(motion, options, 1); });
    const double again = seconds_of([&] { answers = live.readings_of(motion, options, 1); });
    std::vector<double> stated;
    for (const std::vector<ReadingAnswer>& pose : answers)
      for (const ReadingAnswer& reading : pose)
        if (reading.change.value && reading.change.error && std::isfinite(*reading.change.value))
          stated.push_back(100 * *reading.change.error / std::abs(*reading.change.value));
    fmt::print(
        "{}, {} links with {} sensors, rtol {}{}: {} poses, {:.1f} ms each, {:.1f} s to prepare; stated "
        "in the median {:.1f} %\n",
        file.stem().string(), scene.links.size(), scene.sensors.size(), rtol, how, motion.size(),
        1e3 * again / static_cast<double>(motion.size()), first - again, quantile(stated, 0.5));
    std::fflush(stdout);
  };
  report("");
  if (!folder)
    return;
  options.prepared = *folder;
  report(", prepared data written");
  report(", prepared data read");
}

}  // namespace fringe::benchmarks
