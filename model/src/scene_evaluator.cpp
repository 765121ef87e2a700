#include "fringe/scene_evaluator.hpp"

#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "fringe/error.hpp"
#include "fringe/pose.hpp"
#include "fringe/triangulation.hpp"
#include "link_motion.hpp"
#include "surface_integral.hpp"

namespace fringe {
namespace {

using detail::Enclosure;
using detail::Surface;
using detail::SurfaceIntegral;

void validate(const CapacitanceOptions& options) {
  if (!std::isfinite(options.tolerance) || options.tolerance < 0)
    throw InputError(fmt::format("tolerance {} must be finite and not negative", options.tolerance));
  if (options.tolerance > 0 && !std::holds_alternative<Exact>(options.method))
    throw InputError(fmt::format("a tolerance needs the method exact: {} does not know its own error",
                                 to_string(options.method)));
}

Surface surface_of(const Object& object) {
  if (!std::holds_alternative<Grounded>(object.role))
    throw InputError(
        fmt::format("object \"{}\" is {}: the triangle-integral model knows only grounded conductors",
                    object.name, std::holds_alternative<Floating>(object.role) ? "floating" : "dielectric"));
  std::vector<Triangle> triangles = triangulate(object.shape);
  if (triangles.empty())
    throw InputError(fmt::format("object \"{}\" has no triangles", object.name));
  try {
    return detail::make_surface(std::move(triangles));
  } catch (const InputError& error) {
    throw InputError(fmt::format("object \"{}\": {}", object.name, error.what()));
  }
}

std::vector<Rectangle> moved(const Sensor& sensor, const Eigen::Isometry3d& pose) {
  std::vector<Rectangle> plates;
  for (const Rectangle& plate : sensor.plates) {
    const Rectangle& placed = plates.emplace_back(transformed(plate, pose));
    try {
      validate(placed);
      if (!(placed.corner + placed.edge_u + placed.edge_v).allFinite())
        throw InputError("the rectangle reaches too far");
    } catch (const InputError& error) {
      throw InputError(
          fmt::format("sensor \"{}\": plates[{}]: {}", sensor.name, plates.size() - 1, error.what()));
    }
  }
  return plates;
}

/// What is known of one sensor and one object.
struct Pair {
  std::vector<Rectangle> plates;  ///< the sensor's, in the object's frame
  Enclosure enclosure;
  SurfaceIntegral integral;
  bool known = false;
};

}  // namespace

class SceneEvaluator::Implementation {
 public:
  Implementation(const Scene& scene, const CapacitanceOptions& options)
      : options_(options), permittivity_(vacuum_permittivity * scene.medium.relative_permittivity),
        motion_(scene.links), sensors_(scene.sensors) {
    validate(options);
    for (const Object& object : scene.objects) {
      surfaces_.push_back(surface_of(object));
      attachments_.push_back({object.link, object.pose});
    }
    pairs_.resize(sensors_.size() * surfaces_.size());
    for (const Sensor& sensor : sensors_) {
      SensorCapacitance felt{sensor.name, 0, 0, 0, false, {}};
      for (const Object& object : scene.objects)
        felt.objects.push_back({object.name, 0, 0, false});
      answer_.sensors.push_back(std::move(felt));
    }
  }

  void set_pose(std::string_view link, const Eigen::Isometry3d& pose) { motion_.set_pose(link, pose); }

  const SceneCapacitance& capacitance() {
    answer_.counts = {};
    motion_.update();
    for (std::size_t sensor = 0; sensor < sensors_.size(); ++sensor)
      evaluate(sensor);
    motion_.settle();
    ++answers_;
    return answer_;
  }

 private:
  struct Attachment {
    std::optional<std::size_t> link;
    Eigen::Isometry3d pose;
  };

  bool lumps() const { return options_.tolerance > 0 && options_.plates == PlateRule::sum; }

  void evaluate(std::size_t sensor) {
    const std::span<Pair> pairs = std::span(pairs_).subspan(sensor * surfaces_.size(), surfaces_.size());
    for (std::size_t object = 0; object < pairs.size(); ++object)
      place(sensor, object, pairs[object]);
    const double allowance = allowance_per_object(pairs);
    for (std::size_t object = 0; object < pairs.size(); ++object)
      integrate(pairs[object], surfaces_[object], allowance);
    tell(sensor, pairs);
  }

  /// Forgets what is known of a pair that has moved relative to each other.
  void place(std::size_t sensor, std::size_t object, Pair& pair) {
    if (pair.known && motion_.rigid(sensors_[sensor].link, attachments_[object].link))
      return;
    pair.known = false;
    const Eigen::Isometry3d to_object =
        (motion_.world_pose(attachments_[object].link) * attachments_[object].pose).inverse(Eigen::Isometry);
    pair.plates = moved(sensors_[sensor], to_object * motion_.world_pose(sensors_[sensor].link));
    if (lumps())
      pair.enclosure = detail::enclosure(surfaces_[object], pair.plates);
  }

  /// Half of the tolerance goes with each object's own integral. The other half, of what the objects add up
  /// to at least, is divided among them equally: the many that hardly matter need no accuracy of their own.
  double allowance_per_object(std::span<const Pair> pairs) const {
    if (!lumps() || options_.faces == FaceRule::facing)
      return 0;
    double total = 0;
    for (const Pair& pair : pairs)
      total += pair.enclosure.lower;
    return options_.tolerance / 2 * total / static_cast<double>(pairs.size());
  }

  void integrate(Pair& pair, Surface& surface, double allowance) {
    const double own = options_.tolerance / 2 * (pair.integral.value - pair.integral.bound);
    if (pair.known && (!lumps() || pair.integral.bound <= own + allowance)) {
      ++answer_.counts.objects_reused;
      answer_.counts.triangles_reused += pair.plates.size() * surface.triangles.size();
      return;
    }
    const Enclosure& known = pair.enclosure;
    if (allowance > 0 && (known.upper - known.lower) / 2 <= allowance) {
      pair.integral = {(known.upper + known.lower) / 2, (known.upper - known.lower) / 2, true, {}};
      pair.integral.counts.objects_skipped = 1;
      pair.integral.counts.triangles_skipped = pair.plates.size() * surface.triangles.size();
    } else {
      if (lumps() && answers_ > 0 && !surface.tree)
        surface.tree.emplace(surface.triangles);
      CapacitanceOptions options = options_;
      if (lumps() && options_.faces == FaceRule::all)
        options.tolerance /= 2;
      pair.integral = detail::surface_integral(surface, pair.plates, options, allowance);
    }
    pair.known = true;
    answer_.counts += pair.integral.counts;
  }

  void tell(std::size_t sensor, std::span<const Pair> pairs) {
    SensorCapacitance& felt = answer_.sensors[sensor];
    felt.total = 0;
    for (std::size_t object = 0; object < pairs.size(); ++object) {
      const SurfaceIntegral& integral = pairs[object].integral;
      ObjectCapacitance& share = felt.objects[object];
      share.capacitance = permittivity_ * integral.value;
      share.bound = permittivity_ * integral.bound;
      share.skipped = integral.skipped;
      felt.total += share.capacitance;
    }
    felt.voltage = divider_voltage(sensors_[sensor], felt.total);
    felt.delta_voltage = sensors_[sensor].input_voltage - felt.voltage;
    felt.contact = std::isinf(felt.total);
  }

  CapacitanceOptions options_;
  double permittivity_;
  detail::LinkMotion motion_;
  std::vector<Sensor> sensors_;
  std::vector<Surface> surfaces_;
  std::vector<Attachment> attachments_;
  std::vector<Pair> pairs_;  ///< of the first sensor with every object, then of the second
  SceneCapacitance answer_;
  std::size_t answers_ = 0;
};

SceneEvaluator::SceneEvaluator(const Scene& scene, const CapacitanceOptions& options)
    : implementation_(std::make_unique<Implementation>(scene, options)) {}
SceneEvaluator::~SceneEvaluator() = default;
SceneEvaluator::SceneEvaluator(SceneEvaluator&&) noexcept = default;
SceneEvaluator& SceneEvaluator::operator=(SceneEvaluator&&) noexcept = default;

void SceneEvaluator::set_pose(std::string_view link, const Eigen::Isometry3d& pose) {
  implementation_->set_pose(link, pose);
}

const SceneCapacitance& SceneEvaluator::capacitance() {
  return implementation_->capacitance();
}

}  // namespace fringe
