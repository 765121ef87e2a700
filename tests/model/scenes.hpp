#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "fringe/capacitance.hpp"
#include "fringe/error.hpp"
#include "fringe/scene.hpp"
#include "fringe/triangle.hpp"
#include "fringe/triangulation.hpp"

/// Builds scenes for the tests of boundary elements.
namespace fringe::test {

inline Sensor sensor(const std::string& name, const std::vector<Rectangle>& plates) {
  return {name, {}, 2.5, 5e-12, plates};
}

/// Returns a square plate of a given side in the plane z = height.
inline Rectangle square(double side, double height) {
  return {{-side / 2, -side / 2, height}, {side, 0, 0}, {0, side, 0}};
}

inline Object object(const std::string& name, const Shape& shape, const Eigen::Isometry3d& pose,
                     const ElectricalRole& role = Grounded{}) {
  return {name, {}, shape, pose, role, true};
}

inline Eigen::Isometry3d at(double x, double y, double z) {
  return Eigen::Isometry3d(Eigen::Translation3d(x, y, z));
}

/// Returns a box between two corners, in centimetres.
inline Object box(const std::string& name, const Eigen::Vector3d& low, const Eigen::Vector3d& high) {
  const Eigen::Vector3d size = 0.01 * (high - low), centre = 0.005 * (low + high);
  return object(name, Cuboid{size.x(), size.y(), size.z()}, at(centre.x(), centre.y(), centre.z()));
}

/// Returns a square sensor of 3 cm, 1 cm below the objects.
inline Scene above_sensor(const std::vector<Object>& objects) {
  Scene scene;
  scene.sensors = {sensor("front", {square(0.03, -0.01)})};
  scene.objects = objects;
  return scene;
}

/// Returns the surface of a prism whose base is the letter L with its outer corner at the origin: the foot
/// lies along x, the leg along y, and both are as wide as the prism is high.
inline std::vector<Triangle> angle_iron(double foot, double leg, double width) {
  using Eigen::Vector3d;
  const std::array<Vector3d, 6> outline{Vector3d(0, 0, 0),        Vector3d(foot, 0, 0),
                                        Vector3d(foot, width, 0), Vector3d(width, width, 0),
                                        Vector3d(width, leg, 0),  Vector3d(0, leg, 0)};
  const Vector3d up(0, 0, width);
  std::vector<Triangle> triangles;
  for (std::size_t k = 0; k < 6; ++k) {
    const Vector3d &from = outline[k], &to = outline[(k + 1) % 6];
    triangles.push_back({from, to, to + up});
    triangles.push_back({from, to + up, from + up});
    // The letter is divided into triangles from its concave corner, from which all of it is visible.
    if (k == 2 || k == 3)
      continue;
    triangles.push_back({outline[3] + up, from + up, to + up});
    triangles.push_back({outline[3], to, from});
  }
  return triangles;
}

/// Returns the surface of the angle iron of 6 cm by 5 cm by 2 cm as two boxes that cross.
inline std::vector<Triangle> crossing_boxes() {
  std::vector<Triangle> triangles = triangulate(Cuboid{0.06, 0.02, 0.02});
  for (Triangle& triangle : triangles)
    for (Eigen::Vector3d& corner : triangle)
      corner += Eigen::Vector3d(0.03, 0.01, 0.01);
  for (Triangle triangle : triangulate(Cuboid{0.02, 0.04, 0.02})) {
    for (Eigen::Vector3d& corner : triangle)
      corner += Eigen::Vector3d(0.01, 0.03, 0.01);
    triangles.push_back(triangle);
  }
  return triangles;
}

/// Halves every other triangle, but not its neighbours.
inline std::vector<Triangle> with_t_junctions(const std::vector<Triangle>& surface) {
  std::vector<Triangle> triangles;
  for (const Triangle& triangle : surface) {
    const Eigen::Vector3d middle = (triangle[0] + triangle[1]) / 2;
    if (triangles.size() % 3 == 0)
      triangles.push_back({triangle[0], middle, triangle[2]});
    triangles.push_back({triangles.size() % 3 == 1 ? middle : triangle[0], triangle[1], triangle[2]});
  }
  return triangles;
}

inline Scene plate_above_sensor() {
  Scene scene;
  scene.sensors = {sensor("front", {square(0.1, 0)})};
  scene.objects = {object("target", Plate{0.1, 0.1}, at(0, 0, 0.02))};
  return scene;
}

/// Returns the message with which a solver refuses a changed plate_above_sensor; "accepted" if it does not.
inline std::string refusal(const std::function<void(Scene&)>& change,
                           const std::function<void(const Scene&)>& solve) {
  Scene scene = plate_above_sensor();
  change(scene);
  try {
    solve(scene);
  } catch (const InputError& error) {
    return error.what();
  }
  return "accepted";
}

/// Returns C/(4πε₀·length).
inline double per_length(double capacitance, double length) {
  return capacitance / (4 * EIGEN_PI * vacuum_permittivity * length);
}

}  // namespace fringe::test
