#include "scene/scene_evaluator.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "formula/formula.hpp"
#include "formula/layer_rule.hpp"
#include "fringe/error.hpp"
#include "fringe/pose.hpp"
#include "fringe/triangulation.hpp"
#include "scene/options.hpp"
#include "scene/readings_of_objects.hpp"

namespace fringe {
namespace {

using detail::Enclosure;
using detail::Surface;
using detail::SurfaceIntegral;

/// Returns what an object is that is not grounded, for a message.
std::string_view kind_of(const ElectricalRole& role) {
  return std::holds_alternative<Floating>(role) ? "floating" : "an electrode";
}

/// Prepares the surface of an object. Throws InputError for an object that the model does not support.
Surface surface_of(const Object& object, const detail::IntegralOptions& options) {
  if (std::holds_alternative<Dielectric>(object.role))
    throw InputError(fmt::format("object \"{}\" is dielectric: the triangle integrals and the formula know "
                                 "only covers; boundary-elements, reduced and the field solver take it",
                                 object.name));
  if (!std::holds_alternative<Grounded>(object.role))
    throw InputError(
        fmt::format("object \"{}\" is {}: the triangle-integral model knows only grounded conductors",
                    object.name, kind_of(object.role)));
  std::vector<Triangle> triangles = triangulate(object.shape);
  if (triangles.empty())
    throw InputError(fmt::format("object \"{}\" has no triangles", object.name));
  // A mesh may have triangles twice. Where outward sides count, one that faces the other way is another
  // triangle. A mesh that is not finite is refused below, by the number that the triangle has in its file.
  if (std::holds_alternative<Mesh>(object.shape) && axis_aligned_box(triangles).sizes().allFinite())
    triangles = without_duplicates(
        std::move(triangles),
        options.faces == FaceRule::all && is_integral(options.method) ? Sides::alike : Sides::distinct);
  try {
    return detail::make_surface(std::move(triangles));
  } catch (const InputError& error) {
    throw InputError(fmt::format("object \"{}\": {}", object.name, error.what()));
  }
}

}  // namespace

SceneEvaluator::SceneEvaluator(const Scene& scene, const EvaluationOptions& options)
    : SceneEvaluator(scene, options, std::make_shared<detail::LinkPoses>(scene.links)) {}

SceneEvaluator::SceneEvaluator(const Scene& scene, const EvaluationOptions& options,
                               const std::shared_ptr<detail::LinkPoses>& poses)
    : options_(detail::integral_options(options)),
      permittivity_(vacuum_permittivity * scene.medium.relative_permittivity), motion_(poses) {
  const std::vector<bool> are_known = detail::have_capacitances(scene);
  if (std::find(are_known.begin(), are_known.end(), false) == are_known.end()) {
    prepare(scene, options);
    return;
  }
  // Electrodes are left out: to the triangle-integral model they are as other sensors are, of which it knows
  // nothing. Covers are replaced by the layer rule.
  Scene known = detail::without_covers(scene, detail::CoveredPlate::moved);
  known.objects.clear();
  for (std::size_t k = 0; k < scene.objects.size(); ++k)
    if (are_known[k])
      known.objects.push_back(scene.objects[k]);
  prepare(known, options);
}

SceneEvaluator::PlacedSensor SceneEvaluator::placed(const Sensor& sensor, const Eigen::Isometry3d& pose) {
  PlacedSensor result;
  for (const Rectangle& plate : sensor.plates) {
    const Rectangle& moved = result.plates.emplace_back(transformed(plate, pose));
    try {
      validate(moved);
      if (!(moved.corner + moved.edge_u + moved.edge_v).allFinite())
        throw InputError("the rectangle reaches too far");
    } catch (const InputError& error) {
      throw InputError(
          fmt::format("sensor \"{}\": plates[{}]: {}", sensor.name, result.plates.size() - 1, error.what()));
    }
    result.frames.push_back(detail::plate_frame(moved));
  }
  return result;
}

void SceneEvaluator::prepare(const Scene& scene, const EvaluationOptions& options) {
  sensors_ = scene.sensors;
  placed_sensors_.resize(sensors_.size());
  for (const Object& object : scene.objects)
    objects_.push_back(
        {object.link, object.pose, surface_of(object, options_), rule_for(object.shape, options.faces)});
  pairs_.resize(sensors_.size() * objects_.size());
  const std::string name = method_text(options);
  for (const Sensor& sensor : sensors_) {
    SensorCapacitance felt{sensor.name, 0, 0, 0, false, {}};
    for (const Object& object : scene.objects)
      felt.objects.push_back({object.name, 0, 0, false, name, std::nullopt});
    answer_.sensors.push_back(std::move(felt));
  }
  if (is_integral(options_.method))
    return;
  for (const Sensor& sensor : sensors_) {
    // Throws for invalid plates before they are used.
    placed(sensor, Eigen::Isometry3d::Identity());
    charged_sensors_.push_back(detail::make_charged_surface(detail::plate_triangles(sensor.plates)));
  }
  for (std::size_t i = 0; i < objects_.size(); ++i) {
    const Surface& surface = objects_[i].surface;
    if (std::none_of(surface.triangles.begin(), surface.triangles.end(), detail::has_area))
      throw InputError(
          fmt::format("object \"{}\" has no area, and so no charge to correct", scene.objects[i].name));
    charged_objects_.push_back(detail::make_charged_surface(surface.triangles));
  }
}

const SceneCapacitance& SceneEvaluator::capacitance() {
  answer_.counts = {};
  motion_.update();
  place();
  for (std::size_t sensor = 0; sensor < sensors_.size(); ++sensor)
    evaluate(sensor);
  motion_.settle();
  ++answers_;
  return answer_;
}

PoseDerivatives SceneEvaluator::derivatives(std::size_t sensor, std::size_t object) {
  if (!std::holds_alternative<Exact>(options_.method))
    throw InputError("derivatives of an object's capacitance are known by the method exact");
  Pair& pair = pairs_.at(sensor * objects_.size() + object);
  PlacedObject& placed = objects_[object];
  if (!pair.wrench) {
    detail::IntegralOptions options = options_;
    options.faces = placed.faces;
    place_in_frame_of(placed, placed_sensors_[sensor].plates);
    pair.wrench = detail::surface_wrench(placed.surface, in_object_frame_, options);
  }
  const detail::Wrench wrench = permittivity_ * in_outer_frame(*pair.wrench, placed.to_world);
  PoseDerivatives result;
  result << wrench.force, wrench.torque;
  return result;
}

bool SceneEvaluator::has_moved(std::optional<std::size_t> link) const {
  return answers_ == 0 || !motion_.rigid(link, std::nullopt);
}

void SceneEvaluator::place() {
  for (std::size_t i = 0; i < sensors_.size(); ++i)
    if (has_moved(sensors_[i].link))
      placed_sensors_[i] = placed(sensors_[i], motion_.world_pose(sensors_[i].link));
  for (PlacedObject& object : objects_) {
    if (!has_moved(object.link))
      continue;
    object.to_world = motion_.world_pose(object.link) * object.on_link;
    object.from_world = object.to_world.inverse(Eigen::Isometry);
    object.centroid = object.to_world * object.surface.centroid;
  }
}

void SceneEvaluator::place_in_frame_of(const PlacedObject& object, std::span<const Rectangle> plates) {
  in_object_frame_.clear();
  for (const Rectangle& plate : plates)
    in_object_frame_.push_back(transformed(plate, object.from_world));
}

void SceneEvaluator::evaluate(std::size_t sensor) {
  const std::span<Pair> pairs = std::span(pairs_).subspan(sensor * objects_.size(), objects_.size());
  for (std::size_t object = 0; object < pairs.size(); ++object) {
    Pair& pair = pairs[object];
    pair.known = pair.known && motion_.rigid(sensors_[sensor].link, objects_[object].link);
    if (!pair.known)
      pair.wrench.reset();
    if (!pair.known && lumps())
      pair.enclosure = detail::enclosure(objects_[object].surface, objects_[object].centroid,
                                         placed_sensors_[sensor].frames);
  }
  const double allowance = allowance_per_object(pairs);
  for (std::size_t object = 0; object < pairs.size(); ++object)
    if (is_integral(options_.method))
      integrate(pairs[object], objects_[object], placed_sensors_[sensor].plates, allowance);
    else
      combine(pairs[object], sensor, object);
  tell(sensor, pairs);
}

double SceneEvaluator::allowance_per_object(std::span<const Pair> pairs) const {
  if (!lumps() || options_.faces == FaceRule::facing)
    return 0;
  double total = 0;
  for (const Pair& pair : pairs)
    total += pair.enclosure.lower;
  return options_.tolerance / 2 * total / static_cast<double>(pairs.size());
}

void SceneEvaluator::integrate(Pair& pair, PlacedObject& object, std::span<const Rectangle> plates,
                               double allowance) {
  Surface& surface = object.surface;
  const double own = options_.tolerance / 2 * (pair.integral.value - pair.integral.bound);
  if (pair.known && (!lumps() || pair.integral.bound <= own + allowance)) {
    ++answer_.counts.objects_reused;
    answer_.counts.triangles_reused += plates.size() * surface.triangles.size();
    return;
  }
  const Enclosure& known = pair.enclosure;
  if (allowance > 0 && (known.upper - known.lower) / 2 <= allowance) {
    pair.integral = {(known.upper + known.lower) / 2, (known.upper - known.lower) / 2, true, {}};
    pair.integral.counts.objects_skipped = 1;
    pair.integral.counts.triangles_skipped = plates.size() * surface.triangles.size();
  } else {
    if (lumps() && answers_ > 0 && !surface.tree)
      surface.tree.emplace(surface.triangles);
    detail::IntegralOptions options = options_;
    options.faces = object.faces;
    if (lumps() && options_.faces == FaceRule::all)
      options.tolerance /= 2;
    place_in_frame_of(object, plates);
    pair.integral = detail::surface_integral(surface, in_object_frame_, options, allowance);
  }
  pair.known = true;
  answer_.counts += pair.integral.counts;
}

void SceneEvaluator::combine(Pair& pair, std::size_t sensor, std::size_t object) {
  const std::vector<Rectangle>& plates = placed_sensors_[sensor].plates;
  const PlacedObject& before = objects_[object];
  const std::size_t triangles = plates.size() * before.surface.triangles.size();
  if (pair.known) {
    ++answer_.counts.objects_reused;
    answer_.counts.triangles_reused += triangles;
    return;
  }
  pair.known = true;
  ++answer_.counts.objects_evaluated;
  answer_.counts.triangles_evaluated += triangles;
  pair.integral = {};
  place_in_frame_of(before, plates);
  const Eigen::Isometry3d sensor_pose = before.from_world * motion_.world_pose(sensors_[sensor].link);
  // The integral detects contact; it is not needed if the object's bounding sphere is off the plates.
  if (std::isinf(detail::enclosure(before.surface, before.centroid, placed_sensors_[sensor].frames).upper))
    pair.integral = detail::surface_integral(before.surface, in_object_frame_, {}, 0);
  if (!std::isinf(pair.integral.value))
    pair.integral.value = detail::formula(detail::formula_terms(
        charged_objects_[object], charged_sensors_[sensor], sensor_pose, in_object_frame_));
}

void SceneEvaluator::tell(std::size_t sensor, std::span<const Pair> pairs) {
  SensorCapacitance& felt = answer_.sensors[sensor];
  felt.total = 0;
  for (std::size_t object = 0; object < pairs.size(); ++object) {
    const SurfaceIntegral& integral = pairs[object].integral;
    ObjectCapacitance& share = felt.objects[object];
    share.capacitance = permittivity_ * integral.value;
    share.bound = permittivity_ * integral.bound;
    // That two conductors in contact have no finite capacitance is certain.
    share.error = std::isinf(share.capacitance) ? std::optional(0.0) : std::nullopt;
    share.skipped = integral.skipped;
    felt.total += share.capacitance;
  }
  felt.voltage = divider_voltage(sensors_[sensor], felt.total);
  felt.delta_voltage = sensors_[sensor].input_voltage - felt.voltage;
  felt.contact = std::isinf(felt.total);
}

}  // namespace fringe
