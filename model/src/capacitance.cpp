#include "fringe/capacitance.hpp"

#include <cmath>
#include <span>

#include <fmt/format.h>

#include "fringe/conductors.hpp"
#include "fringe/error.hpp"
#include "fringe/plate_integral.hpp"
#include "fringe/pose.hpp"

namespace fringe {
namespace {

void require_grounded(const Scene& scene) {
  for (const Object& object : scene.objects)
    if (!std::holds_alternative<Grounded>(object.role))
      throw InputError(fmt::format(
          "object \"{}\" is {}: the triangle-integral model knows only grounded conductors", object.name,
          std::holds_alternative<Floating>(object.role) ? "floating" : "dielectric"));
}

/// Σ∫dA/d over the plates and the triangles, in metres.
double integral(std::span<const Rectangle> plates, std::span<const Triangle> triangles,
                const Method& method) {
  double sum = 0;
  for (const Rectangle& plate : plates)
    for (const double value : plate_integrals(triangles, plate, method))
      sum += value;
  return sum;
}

}  // namespace

double divider_voltage(const Sensor& sensor, double total) {
  return sensor.coupling_capacitance / (sensor.coupling_capacitance + total) * sensor.input_voltage;
}

std::vector<SensorCapacitance> capacitance(const Scene& scene, const CapacitanceOptions& options) {
  require_grounded(scene);
  const double permittivity = vacuum_permittivity * scene.medium.relative_permittivity;
  const std::vector<Eigen::Isometry3d> link_poses = world_poses(scene.links);
  const std::vector<Conductor> surfaces = conductors(scene);
  const std::span<const Conductor> objects = std::span(surfaces).subspan(scene.sensors.size());

  std::vector<SensorCapacitance> result;
  for (const Sensor& sensor : scene.sensors) {
    std::vector<Rectangle> plates;
    for (const Rectangle& plate : sensor.plates)
      plates.push_back(transformed(plate, attachment_pose(link_poses, sensor.link)));

    SensorCapacitance felt{sensor.name, 0, 0, 0, false, {}};
    for (const Conductor& object : objects) {
      const double share = permittivity * integral(plates, object.triangles, options.method);
      felt.objects.push_back({object.name, share, 0, false});
      felt.total += share;
    }
    felt.voltage = divider_voltage(sensor, felt.total);
    felt.delta_voltage = sensor.input_voltage - felt.voltage;
    felt.contact = std::isinf(felt.total);
    result.push_back(std::move(felt));
  }
  return result;
}

}  // namespace fringe
