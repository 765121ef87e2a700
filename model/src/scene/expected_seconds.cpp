#include "scene/expected_seconds.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <variant>

#include "fringe/triangulation.hpp"
#include "surface/insulators.hpp"

namespace fringe::detail {
namespace {

double seconds_of_formula(const SceneSize& size) {
  constexpr double per_triangle = 4e-6;
  return per_triangle * size.triangles * size.sensors;
}

/// Fitted to 190 random scenes of 2 to 9 bodies (`analysis honesty`): the preparation of boxes, and far more
/// that of other bodies and of those that touch as one conductor, takes most of it. That of machines was
/// measured on seven of 28 to 32,548 triangles.
double seconds_of_reduction(const SceneSize& size, const Effort& effort) {
  constexpr double per_pair = 2e-6, per_plate = 4e-4, per_pair_of_boxes = 0.015;
  constexpr double per_curved_body = 2, per_joined_conductor = 6;
  constexpr double per_pose = 1e-3, machine = 2, per_triangle = 1e-3;
  constexpr double rough_machine = 0.6, rough_triangle = 9e-5;
  if (effort.is_rough)
    return rough_machine + rough_triangle * size.prepared_triangles;
  if (effort.is_by_matrix)
    return per_pair * size.bodies() * size.bodies() +
           (effort.is_prepared
                ? 0
                : per_plate * size.plates + per_pair_of_boxes * size.boxes * size.boxes +
                      per_curved_body * size.curved + per_joined_conductor * size.joined_conductors);
  return effort.is_prepared ? per_pose : machine + per_triangle * size.prepared_triangles;
}

/// Fitted to 270 such scenes at 1e-2: 62 % of those without insulators took half to twice as long. Guards
/// near a sensor take five times as long, isolated bodies a third. Of the bodies of a machine most are far
/// from what is asked for: more of them take little more.
double seconds_of_boundary_elements(const SceneSize& size, const Effort& effort) {
  constexpr double of_plate = 0.07, of_box = 0.15, of_curved = 0.38, by_curved = 0.38, power = 3.8;
  constexpr double most_bodies = 12, of_insulators = 6, of_covers = 15;
  constexpr double usual_rtol = 1e-2, by_rtol = 0.4;
  const double of_conductors =
      std::pow(of_plate * std::min(size.plates, most_bodies) + of_box * std::min(size.boxes, most_bodies) +
                   of_curved * std::pow(size.curved, by_curved),
               power);
  double of_dielectrics = 0;
  if (size.has_insulators)
    of_dielectrics = size.has_covers ? of_covers : of_insulators;
  return (of_conductors + of_dielectrics) * std::pow(usual_rtol / effort.rtol, by_rtol);
}

}  // namespace

SceneSize::SceneSize(const Scene& scene)
    : sensors(static_cast<double>(scene.sensors.size())), has_insulators(detail::has_insulators(scene)) {
  for (const Sensor& sensor : scene.sensors)
    plates += static_cast<double>(sensor.plates.size());
  std::map<std::string, std::size_t> members;
  for (const Object& object : scene.objects) {
    if (object.conductor && ++members[*object.conductor] == 2)
      ++joined_conductors;
    const auto count = static_cast<double>(triangulate(object.shape).size());
    triangles += count;
    has_covers = has_covers || is_cover(object);
    if (std::holds_alternative<Plate>(object.shape)) {
      ++plates;
    } else if (std::holds_alternative<Cuboid>(object.shape)) {
      ++boxes;
    } else {
      prepared_triangles += count;
      ++curved;
    }
  }
}

double expected_seconds(const Method& method, const SceneSize& size, const Effort& effort) {
  constexpr double per_integral = 3e-7;
  if (std::holds_alternative<Formula>(method))
    return seconds_of_formula(size);
  if (std::holds_alternative<Reduced>(method))
    return seconds_of_reduction(size, effort);
  if (std::holds_alternative<BoundaryElements>(method))
    return seconds_of_boundary_elements(size, effort);
  const auto* split = std::get_if<Split>(&method);
  return per_integral * size.triangles * size.sensors * (split != nullptr ? std::pow(4, split->levels) : 1);
}

}  // namespace fringe::detail
