#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "fringe/capacitance.hpp"
#include "fringe/error.hpp"
#include "fringe/live_scene.hpp"
#include "fringe/maxwell_matrix.hpp"
#include "fringe/reading.hpp"
#include "fringe/scene.hpp"
#include "fringe/triangle.hpp"
#include "fringe/triangulation.hpp"

namespace fringe {

/// Evaluates a scene once, in the poses that it has.
inline Evaluation evaluate(const Scene& scene, const EvaluationOptions& options = {}) {
  return LiveScene(scene).evaluate(options);
}

}  // namespace fringe

/// Builds scenes for the tests, and compares answers within their errors.
namespace fringe::test {

inline Sensor sensor(const std::string& name, const std::vector<Rectangle>& plates) {
  return {name, {}, 2.5, 5e-12, plates};
}

/// Returns a plate in the plane z = height, with its middle on the z axis.
inline Rectangle rectangle(double side_x, double side_y, double height) {
  return {{-side_x / 2, -side_y / 2, height}, {side_x, 0, 0}, {0, side_y, 0}};
}

inline Rectangle square(double side, double height) {
  return rectangle(side, side, height);
}

inline Object object(const std::string& name, const Shape& shape, const Eigen::Isometry3d& pose,
                     const ElectricalRole& role = Grounded{}) {
  return {name, {}, shape, pose, role, true};
}

inline Eigen::Isometry3d at(double x, double y, double z) {
  return Eigen::Isometry3d(Eigen::Translation3d(x, y, z));
}

inline Object object(const std::string& name, const Shape& shape, const Eigen::Vector3d& place,
                     const ElectricalRole& role = Grounded{}) {
  return object(name, shape, at(place.x(), place.y(), place.z()), role);
}

/// Returns a box between two corners, in centimetres.
inline Object box(const std::string& name, const Eigen::Vector3d& low, const Eigen::Vector3d& high,
                  const ElectricalRole& role = Grounded{}) {
  const Eigen::Vector3d size = 0.01 * (high - low), centre = 0.005 * (low + high);
  return object(name, Cuboid{size.x(), size.y(), size.z()}, centre, role);
}

inline Object target(Object object) {
  object.target = true;
  return object;
}

/// Returns an object or a sensor on a link, which is given by its number.
template <typename Part>
Part on_link(std::size_t link, Part part) {
  part.link = link;
  return part;
}

/// Returns a sensor "front" of one plate, and objects.
inline Scene scene_of(const Rectangle& plate, const std::vector<Object>& objects) {
  Scene scene;
  scene.sensors = {sensor("front", {plate})};
  scene.objects = objects;
  return scene;
}

/// Returns two boxes that touch: together they are the angle iron of 6 cm by 5 cm by 2 cm.
inline std::vector<Object> foot_and_leg() {
  return {box("foot", {0, 0, 0}, {6, 2, 2}), box("leg", {0, 2, 0}, {2, 5, 2})};
}

/// Returns a square sensor of 3 cm, 1 cm below the objects.
inline Scene above_sensor(const std::vector<Object>& objects) {
  return scene_of(square(0.03, -0.01), objects);
}

/// Returns a sensor of one plate, a sensor of two plates, an inclined box on the link "hand" and a fixed
/// plate.
/// @param scale by which all lengths are multiplied
inline Scene hand_above_sensors(double scale = 1) {
  const auto plate = [&](double x, double y, double height) {
    return Rectangle{scale * Eigen::Vector3d(x, y, 0), {0.05 * scale, 0, 0}, {0, height * scale, 0}};
  };
  Scene scene;
  scene.links = {{"hand", {}, Eigen::Isometry3d::Identity()}};
  scene.sensors = {sensor("left", {plate(-0.06, -0.05, 0.1)}),
                   sensor("right", {plate(0.01, -0.05, 0.04), plate(0.01, 0.01, 0.04)})};
  Eigen::Isometry3d turned = at(0.02 * scale, 0.01 * scale, 0.05 * scale);
  turned.rotate(Eigen::AngleAxisd(0.4, Eigen::Vector3d(1, 2, 0.5).normalized()));
  scene.objects = {on_link(0, object("box", Cuboid{0.04 * scale, 0.06 * scale, 0.02 * scale}, turned)),
                   object("plate", Plate{0.08 * scale, 0.05 * scale}, at(-0.05 * scale, 0, -0.02 * scale))};
  return scene;
}

/// Returns a sensor of 6 cm by 8 cm before a housing, and on the link "hand" the target, a hand that is `gap`
/// above the sensor.
inline Scene hand_before_housing(double gap) {
  Scene scene = scene_of(rectangle(0.06, 0.08, 0),
                         {object("housing", Cuboid{0.2, 0.12, 0.05}, at(0, 0, -0.028)),
                          on_link(0, target(object("hand", Cuboid{0.05, 0.09, 0.02}, at(0, 0, 0))))});
  scene.links = {{"hand", {}, at(0, 0, gap + 0.01)}};
  return scene;
}

inline std::vector<Triangle> shifted(std::vector<Triangle> triangles, const Eigen::Vector3d& by) {
  for (Triangle& triangle : triangles)
    for (Eigen::Vector3d& corner : triangle)
      corner += by;
  return triangles;
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
  std::vector<Triangle> triangles = shifted(triangulate(Cuboid{0.06, 0.02, 0.02}), {0.03, 0.01, 0.01});
  for (const Triangle& triangle : shifted(triangulate(Cuboid{0.02, 0.04, 0.02}), {0.01, 0.03, 0.01}))
    triangles.push_back(triangle);
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
  return scene_of(square(0.1, 0), {object("target", Plate{0.1, 0.1}, at(0, 0, 0.02))});
}

/// Returns the message with which a call refuses its input; "accepted" if it does not.
inline std::string refusal_of(const std::function<void()>& call) {
  try {
    call();
  } catch (const InputError& error) {
    return error.what();
  }
  return "accepted";
}

/// Returns the message with which a solver refuses a changed plate_above_sensor; "accepted" if it does not.
inline std::string refusal(const std::function<void(Scene&)>& change,
                           const std::function<void(const Scene&)>& solve) {
  Scene scene = plate_above_sensor();
  change(scene);
  return refusal_of([&] { solve(scene); });
}

/// Returns true if two answers differ by no more than their stated errors together.
inline bool covers(const MaxwellMatrix& answer, const MaxwellMatrix& truth) {
  return ((answer.values - truth.values).array().abs() <= (answer.errors + truth.errors).array()).all() &&
         ((answer.delta_self - truth.delta_self).array().abs() <=
          (answer.delta_self_errors + truth.delta_self_errors).array())
             .all();
}

/// Expects values, backgrounds and changes of readings to agree within their errors.
inline void expect_agreement(const std::vector<ReadingAnswer>& some,
                             const std::vector<ReadingAnswer>& others) {
  ASSERT_EQ(some.size(), others.size());
  for (std::size_t k = 0; k < some.size(); ++k) {
    EXPECT_EQ(some[k].name, others[k].name);
    for (const auto part : {&ReadingAnswer::value, &ReadingAnswer::background, &ReadingAnswer::change}) {
      const Estimate &one = some[k].*part, &other = others[k].*part;
      EXPECT_NEAR(one.value.value(), other.value.value(), one.error.value() + other.error.value())
          << some[k].name;
    }
  }
}

/// Returns C/(4πε₀·length).
inline double per_length(double capacitance, double length) {
  return capacitance / (4 * EIGEN_PI * vacuum_permittivity * length);
}

}  // namespace fringe::test
