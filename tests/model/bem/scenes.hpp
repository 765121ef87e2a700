#pragma once

#include <functional>
#include <string>

#include <Eigen/Geometry>

#include "fringe/capacitance.hpp"
#include "fringe/error.hpp"
#include "fringe/scene.hpp"

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
