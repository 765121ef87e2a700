#include "fringe/scene_info.hpp"

#include <cstddef>
#include <optional>
#include <variant>

#include "fringe/conductors.hpp"

namespace fringe {

SceneInfo scene_info(const Scene& scene) {
  SceneInfo info{scene.links.size(), scene.sensors.size(), scene.distance_sensors.size(), 0, {}};
  const std::vector<Conductor> surfaces = conductors(scene);
  for (std::size_t k = 0; k < scene.objects.size(); ++k) {
    const auto& [name, triangles] = surfaces[scene.sensors.size() + k];
    const auto* mesh = std::get_if<Mesh>(&scene.objects[k].shape);
    info.triangles += triangles.size();
    info.objects.push_back({name, triangles.size(), area(triangles),
                            is_closed(triangles) ? std::optional(signed_volume(triangles)) : std::nullopt,
                            axis_aligned_box(triangles),
                            mesh ? std::optional(mesh_defects(mesh->triangles)) : std::nullopt});
  }
  return info;
}

}  // namespace fringe
