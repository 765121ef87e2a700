#include "formula/layer_rule.hpp"

#include <algorithm>
#include <variant>
#include <vector>

namespace fringe::detail {
namespace {

/// Returns how far a cover moves its plate, in m along the normal of the plate's front.
double shift_of(const Object& cover, const Medium& medium) {
  // The third side of a cover is its thickness.
  const double thickness = std::get<Cuboid>(cover.shape).size_z;
  return thickness *
         (1 - medium.relative_permittivity / std::get<Dielectric>(cover.role).relative_permittivity);
}

}  // namespace

bool has_covers(const Scene& scene) {
  return std::ranges::any_of(scene.objects, is_cover);
}

Scene without_covers(const Scene& scene, CoveredPlate stand_in) {
  Scene result = scene;
  for (Sensor& sensor : result.sensors) {
    const std::vector<Rectangle> plates = sensor.plates;
    std::size_t plate = 0;
    // Covers have the order of their sensor's plates.
    for (const Object& object : scene.objects) {
      if (!is_cover(object) || object.conductor != sensor.name)
        continue;
      Rectangle moved = plates.at(plate);
      moved.corner += shift_of(object, scene.medium) * moved.edge_u.cross(moved.edge_v).normalized();
      if (stand_in == CoveredPlate::moved)
        sensor.plates[plate] = moved;
      else if (moved.corner != plates[plate].corner)
        sensor.plates.push_back(moved);
      ++plate;
    }
  }
  std::erase_if(result.objects, is_cover);
  return result;
}

}  // namespace fringe::detail
