#include "scene/expected_seconds.hpp"

#include <algorithm>
#include <cmath>
#include <variant>

#include "bem/insulators.hpp"
#include "fringe/triangulation.hpp"

namespace fringe::detail {
namespace {

double seconds_of_formula(const SceneSize& size) {
  constexpr double per_triangle = 4e-6;
  return per_triangle * size.triangles * size.sensors;
}

/// The preparation of bodies that are neither plates nor boxes takes most of it. That of machines was
/// measured on seven of 28 to 32,548 triangles.
double seconds_of_reduction(const SceneSize& size, const Effort& effort) {
  constexpr double per_pair = 2e-6, per_flat_body = 2e-3, per_curved_body = 3;
  constexpr double per_pose = 1e-3, machine = 2, per_triangle = 1e-3;
  constexpr double rough_machine = 0.6, rough_triangle = 9e-5;
  if (effort.is_rough)
    return rough_machine + rough_triangle * size.prepared_triangles;
  if (effort.is_by_matrix)
    return per_pair * size.bodies * size.bodies +
           (effort.is_prepared ? 0 : per_curved_body * size.curved + per_flat_body * size.bodies);
  return effort.is_prepared ? per_pose : machine + per_triangle * size.prepared_triangles;
}

/// Fitted to 70 random scenes of 2 to 9 bodies at 1e-2 and 1e-3: 60 % of them took half to twice as long. Of
/// the bodies of a machine most are far from what is asked for, so that no more than some count.
double seconds_of_boundary_elements(const SceneSize& size, const Effort& effort) {
  constexpr double of_body = 1.5e-3, by_bodies = 3.5, per_curved_body = 0.5, usual_rtol = 1e-2, by_rtol = 0.4;
  constexpr double with_insulators = 30;
  constexpr double most_bodies = 12;
  const double of_size = of_body * std::pow(std::clamp(size.bodies, 1.0, most_bodies), by_bodies) +
                         per_curved_body * std::min(size.curved, most_bodies);
  return of_size * std::pow(usual_rtol / effort.rtol, by_rtol) * (size.has_insulators ? with_insulators : 1);
}

}  // namespace

SceneSize::SceneSize(const Scene& scene)
    : sensors(static_cast<double>(scene.sensors.size())), has_insulators(detail::has_insulators(scene)) {
  for (const Sensor& sensor : scene.sensors)
    bodies += static_cast<double>(sensor.plates.size());
  for (const Object& object : scene.objects) {
    const auto count = static_cast<double>(triangulate(object.shape).size());
    triangles += count;
    if (!std::holds_alternative<Plate>(object.shape) && !std::holds_alternative<Cuboid>(object.shape)) {
      prepared_triangles += count;
      ++curved;
    }
    ++bodies;
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
