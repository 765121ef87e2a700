#include "hand_before_arm.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <utility>

#include "fringe/pose.hpp"
#include "fringe/triangulation.hpp"

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

}  // namespace fringe::benchmarks
