#include "page.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>

#include <nlohmann/json.hpp>

#include "answers/answers.hpp"
#include "fringe/batch_integral.hpp"
#include "fringe/capacitance.hpp"
#include "fringe/error.hpp"
#include "fringe/method.hpp"
#include "fringe/pose.hpp"
#include "fringe/reading.hpp"
#include "fringe/scene_reader.hpp"
#include "fringe/triangle_batch.hpp"
#include "fringe/triangulation.hpp"

namespace fringe::browser {
namespace {

using answers::Json;
using Eigen::Isometry3d;
using Eigen::Vector3d;

/// Number of triangles drawn of a scene at most, besides those of its meshes: what a page colours in a few
/// milliseconds.
constexpr std::size_t drawn_triangles = 1500;
/// Number of parts into which the longest edge of an object is divided at most.
constexpr double parts_of_an_edge = 14;
/// Relative error of the colours, far below what an eye tells apart.
constexpr double tolerance_of_colours = 1e-3;

double longest_edge(const Triangle& triangle) {
  return std::max({(triangle[1] - triangle[0]).norm(), (triangle[2] - triangle[1]).norm(),
                   (triangle[0] - triangle[2]).norm()});
}

/// Halves the longest edges of triangles until none is longer than `length` (m).
std::vector<Triangle> divided(const std::vector<Triangle>& triangles, double length) {
  std::vector<Triangle> waiting = triangles, result;
  while (!waiting.empty()) {
    const Triangle triangle = waiting.back();
    waiting.pop_back();
    if (!(longest_edge(triangle) > length)) {
      result.push_back(triangle);
      continue;
    }
    std::size_t first = 0;
    double longest = 0;
    for (std::size_t k = 0; k < 3; ++k)
      if (const double edge = (triangle[(k + 1) % 3] - triangle[k]).norm(); edge > longest) {
        longest = edge;
        first = k;
      }
    const Vector3d &a = triangle[first], &b = triangle[(first + 1) % 3], &c = triangle[(first + 2) % 3];
    const Vector3d middle = (a + b) / 2;
    waiting.push_back({a, middle, c});
    waiting.push_back({middle, b, c});
  }
  return result;
}

/// Divides the triangles of an object so that colours vary along it, into about `most` triangles at most.
std::vector<Triangle> drawn(const std::vector<Triangle>& triangles, std::size_t most) {
  double longest = 0;
  for (const Triangle& triangle : triangles)
    longest = std::max(longest, longest_edge(triangle));
  std::vector<Triangle> best = triangles;
  for (double parts = 2; parts <= parts_of_an_edge; parts *= std::sqrt(2.0)) {
    std::vector<Triangle> finer = divided(triangles, longest / parts);
    if (finer.size() > most)
      break;
    best = std::move(finer);
  }
  return best;
}

std::vector<Triangle> moved(const std::vector<Triangle>& triangles, const Isometry3d& pose) {
  std::vector<Triangle> result;
  result.reserve(triangles.size());
  for (const Triangle& triangle : triangles)
    result.push_back(transformed(triangle, pose));
  return result;
}

/// Two triangles for each plate of a sensor.
std::vector<Triangle> plates_of(const Sensor& sensor) {
  std::vector<Triangle> result;
  for (const auto& [corner, u, v] : sensor.plates) {
    result.push_back({corner, corner + u, corner + u + v});
    result.push_back({corner, corner + u + v, corner + v});
  }
  return result;
}

Json numbers(const std::vector<Triangle>& triangles) {
  Json result = Json::array();
  for (const Triangle& triangle : triangles)
    for (const Vector3d& corner : triangle)
      for (const double coordinate : corner)
        result.push_back(coordinate);
  return result;
}

Json numbers(const Vector3d& vector) {
  return {vector.x(), vector.y(), vector.z()};
}

Json index_or_null(std::optional<std::size_t> index) {
  return index ? Json(*index) : Json();
}

Json quaternion_of(const Isometry3d& pose) {
  const Eigen::Quaterniond turned(pose.linear());
  return {turned.w(), turned.x(), turned.y(), turned.z()};
}

/// Describes a joint; null for a link that has none, or one that follows another joint.
Json description_of(const std::optional<Joint>& joint) {
  if (!joint || joint->mimic)
    return {};
  return {{"name", joint->name},
          {"kind", joint->kind == Joint::Kind::revolute ? "revolute" : "prismatic"},
          {"position", joint->position},
          {"lower", joint->lower ? Json(*joint->lower) : Json()},
          {"upper", joint->upper ? Json(*joint->upper) : Json()}};
}

EvaluationOptions options_of(const std::string& method, double rtol) {
  EvaluationOptions options = with_method({}, method);
  if (rtol > 0)
    options.rtol = rtol;
  return options;
}

}  // namespace

Page::Page(std::string_view text, std::string_view folder)
    : live_(parse_scene(text, std::filesystem::path(folder))) {
  const Scene& scene = live_.scene();
  for (const Object& object : scene.objects) {
    const std::vector<Triangle> triangles = moved(triangulate(object.shape), object.pose);
    objects_.push_back({object.link, drawn(triangles, drawn_triangles / scene.objects.size())});
    densities_.resize(densities_.size() + objects_.back().triangles.size());
  }
}

Json Page::description() const {
  const Scene& scene = live_.scene();
  Json links = Json::array(), sensors = Json::array(), eyes = Json::array(), objects = Json::array();
  for (const Link& link : scene.links)
    links.push_back({{"name", link.name},
                     {"parent", index_or_null(link.parent)},
                     {"translation", numbers(Vector3d(link.pose.translation()))},
                     {"quaternion", quaternion_of(link.pose)},
                     {"joint", description_of(link.joint)}});
  for (const Sensor& sensor : scene.sensors)
    sensors.push_back({{"name", sensor.name},
                       {"link", index_or_null(sensor.link)},
                       {"triangles", numbers(plates_of(sensor))}});
  for (const DistanceSensor& eye : scene.distance_sensors)
    eyes.push_back({{"name", eye.name},
                    {"link", index_or_null(eye.link)},
                    {"apex", numbers(eye.apex)},
                    {"direction", numbers(Vector3d(eye.direction.normalized()))},
                    {"full_angle_degrees", eye.full_angle_degrees},
                    {"range", eye.range}});
  const std::vector<bool> are_targets = targets(scene);
  for (std::size_t k = 0; k < scene.objects.size(); ++k)
    objects.push_back({{"name", scene.objects[k].name},
                       {"link", index_or_null(scene.objects[k].link)},
                       {"target", static_cast<bool>(are_targets[k])},
                       {"triangles", numbers(objects_[k].triangles)}});
  return {{"links", std::move(links)},
          {"sensors", std::move(sensors)},
          {"distance_sensors", std::move(eyes)},
          {"objects", std::move(objects)},
          {"roles", answers::scene_roles(scene)}};
}

template <class Action>
void Page::for_each_copy(const Action& action) {
  action(live_);
  for (auto& [method, copy] : copies_)
    action(copy);
}

void Page::set_pose(std::size_t link, const Isometry3d& pose) {
  const std::string name = live_.scene().links.at(link).name;
  for_each_copy([&](LiveScene& scene) { scene.set_pose(name, pose); });
}

void Page::set_joint(std::string_view joint, double position) {
  for_each_copy([&](LiveScene& scene) { scene.set_joint(joint, position); });
}

void Page::set_floating(std::string_view object, bool is_floating, double to_ground) {
  Scene scene = live_.scene();
  const auto found = std::find_if(scene.objects.begin(), scene.objects.end(),
                                  [&](const Object& each) { return each.name == object; });
  if (found == scene.objects.end())
    throw InputError("there is no object \"" + std::string(object) + "\"");
  if (!std::holds_alternative<Grounded>(found->role) && !std::holds_alternative<Floating>(found->role))
    throw InputError("object \"" + std::string(object) + "\" is neither grounded nor floating");
  if (is_floating)
    found->role = Floating{to_ground};
  else
    found->role = Grounded{};
  live_ = LiveScene(std::move(scene));
  copies_.clear();
}

const std::vector<double>& Page::poses() {
  poses_.clear();
  for (const Isometry3d& pose : world_poses(live_.scene().links))
    for (Eigen::Index row = 0; row < 3; ++row)
      for (Eigen::Index column = 0; column < 4; ++column)
        poses_.push_back(pose.matrix()(row, column));
  return poses_;
}

Json Page::capacitance(const std::string& method, double rtol) {
  const EvaluationOptions options = options_of(method, rtol);
  const auto start = std::chrono::steady_clock::now();
  LiveScene& copy = copies_.try_emplace(method, Scene(live_.scene())).first->second;
  const Evaluation& answer = copy.evaluate(options);
  const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - start;
  return answers::capacitance_answer(answer, options, elapsed.count());
}

Json Page::collisions() {
  return answers::collision_answer(live_.collide(), live_.scene());
}

Json Page::distances() {
  return answers::sensing_answer(live_.sense());
}

const std::vector<float>& Page::densities(std::size_t sensor) {
  const Scene& scene = live_.scene();
  const std::vector<Isometry3d> poses = world_poses(scene.links);
  const Sensor& driven = scene.sensors.at(sensor);
  const Isometry3d sensor_pose = attachment_pose(poses, driven.link);
  const double permittivity = vacuum_permittivity * scene.medium.relative_permittivity;
  const bool is_new = densities_of_ != sensor;
  placed_.resize(objects_.size());
  densities_of_ = sensor;
  float* density = densities_.data();
  for (std::size_t k = 0; k < objects_.size(); ++k) {
    const std::vector<Triangle>& triangles = objects_[k].triangles;
    const Isometry3d pose = attachment_pose(poses, objects_[k].link);
    if (is_new || placed_[k].object != pose.matrix() || placed_[k].sensor != sensor_pose.matrix()) {
      placed_[k] = {pose.matrix(), sensor_pose.matrix()};
      // The plates move into the object's frame, where the triangles stay.
      const Isometry3d to_object = pose.inverse() * sensor_pose;
      const TriangleBatch batch(triangles);
      std::vector<double> sums(triangles.size());
      for (const Rectangle& plate : driven.plates) {
        const std::vector<double> integrals =
            plate_integrals(batch, transformed(plate, to_object), tolerance_of_colours);
        for (std::size_t t = 0; t < sums.size(); ++t)
          sums[t] += integrals[t];
      }
      for (std::size_t t = 0; t < sums.size(); ++t)
        density[t] = static_cast<float>(permittivity * sums[t] / (batch.twice_area()[t] / 2));
    }
    density += triangles.size();
  }
  return densities_;
}

}  // namespace fringe::browser
