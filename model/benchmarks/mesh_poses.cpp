#include "mesh_poses.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "fringe/triangulation.hpp"
#include "random.hpp"

namespace fringe::benchmarks {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

constexpr double half_sensor = 0.05;  ///< half the side of the sensor, m
constexpr double nearest = 0.003;     ///< least distance of a body, m
constexpr double farthest = 0.1;      ///< largest distance of a body, m

/// Makes the closed surface of adjacent cubes, each square of it divided into 2·parts² triangles.
Mesh cubes(const std::vector<Eigen::Vector3i>& cells, double side, int parts) {
  Mesh mesh{"", 1, {}};
  for (const Eigen::Vector3i& cell : cells)
    for (int axis = 0; axis < 3; ++axis)
      for (const int outward : {0, 1}) {
        Eigen::Vector3i neighbour = cell;
        neighbour[axis] += outward == 1 ? 1 : -1;
        if (std::find(cells.begin(), cells.end(), neighbour) != cells.end())
          continue;
        const auto at = [&](int u, int v) {
          Vector3d point = cell.cast<double>();
          point[axis] += outward;
          point[(axis + 1) % 3] += static_cast<double>(u) / parts;
          point[(axis + 2) % 3] += static_cast<double>(v) / parts;
          return Vector3d(side * point);
        };
        for (int u = 0; u < parts; ++u)
          for (int v = 0; v < parts; ++v) {
            Vector3d second = at(u + 1, v), fourth = at(u, v + 1);
            if (outward == 0)
              std::swap(second, fourth);
            mesh.triangles.push_back({at(u, v), second, at(u + 1, v + 1)});
            mesh.triangles.push_back({at(u, v), at(u + 1, v + 1), fourth});
          }
      }
  return mesh;
}

Mesh moved(Mesh mesh, const Vector3d& by) {
  for (Triangle& triangle : mesh.triangles)
    for (Vector3d& corner : triangle)
      corner += by;
  return mesh;
}

/// Estimates the distance of a body from the sensor by points on its triangles.
double distance_from_sensor(const std::vector<Triangle>& triangles, const Isometry3d& pose) {
  constexpr int parts = 4;
  double least = 1;
  for (const Triangle& triangle : triangles)
    for (int i = 0; i <= parts; ++i)
      for (int j = 0; i + j <= parts; ++j) {
        const Vector3d point =
            pose *
            (triangle[0] + (i * (triangle[1] - triangle[0]) + j * (triangle[2] - triangle[0])) / parts);
        least =
            std::min(least, (point.cwiseAbs() - Vector3d(half_sensor, half_sensor, 0)).cwiseMax(0).norm());
      }
  return least;
}

}  // namespace

std::vector<MeshBody> mesh_bodies() {
  const Mesh box = moved(cubes({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {0, 1, 0}, {1, 1, 0}, {2, 1, 0}}, 0.02, 4),
                         {-0.03, -0.02, -0.01});
  const Mesh angle =
      moved(cubes({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {0, 1, 0}, {0, 2, 0}}, 0.02, 5), {-0.022, -0.022, -0.01});
  const Sphere ball{0.03, 34};
  return {{"ball", ball, ball, 1e-3},
          {"box as a mesh", box, Cuboid{0.06, 0.04, 0.02}, 1e-4},
          {"L", angle, angle, 2e-3}};
}

Scene mesh_scene(const Shape& shape) {
  Scene scene;
  scene.links = {{"body", {}, Isometry3d(Eigen::Translation3d(0, 0, 1))}};
  scene.sensors = {{"sensor",
                    {},
                    2.5,
                    5e-12,
                    {{{-half_sensor, -half_sensor, 0}, {2 * half_sensor, 0, 0}, {0, 2 * half_sensor, 0}}}}};
  scene.objects = {{"target", 0, shape, Isometry3d::Identity(), Grounded{}, true}};
  return scene;
}

std::vector<Isometry3d> mesh_poses(const Shape& shape, int count, std::uint64_t seed) {
  const std::vector<Triangle> triangles = triangulate(shape);
  Random random(seed);
  const auto number = [&](double from, double to) { return random.uniform(from, to); };
  std::vector<Isometry3d> poses;
  while (static_cast<int>(poses.size()) < count) {
    Isometry3d pose(Eigen::Translation3d(number(-0.1, 0.1), number(-0.1, 0.1), number(0, 0.15)));
    pose.rotate(Eigen::AngleAxisd(number(0, 2 * std::numbers::pi),
                                  Vector3d(number(-1, 1), number(-1, 1), number(-1, 1)).normalized()));
    const double distance = distance_from_sensor(triangles, pose);
    if (distance >= nearest && distance <= farthest)
      poses.push_back(pose);
  }
  return poses;
}

}  // namespace fringe::benchmarks
