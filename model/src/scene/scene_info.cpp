#include "fringe/scene_info.hpp"

#include <span>

#include "fringe/conductors.hpp"

namespace fringe {

SceneInfo scene_info(const Scene& scene) {
  SceneInfo info{scene.links.size(), scene.sensors.size(), scene.distance_sensors.size(), 0, {}};
  const std::vector<Conductor> surfaces = conductors(scene);
  for (const auto& [name, triangles] : std::span(surfaces).subspan(scene.sensors.size())) {
    info.triangles += triangles.size();
    info.objects.push_back({name, triangles.size(), area(triangles),
                            is_closed(triangles) ? std::optional(signed_volume(triangles)) : std::nullopt,
                            axis_aligned_box(triangles)});
  }
  return info;
}

}  // namespace fringe
