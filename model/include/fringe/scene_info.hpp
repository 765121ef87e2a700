#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "fringe/mesh_defects.hpp"
#include "fringe/scene.hpp"

namespace fringe {

/// The geometry of an object in the world frame.
struct ObjectInfo {
  std::string name;
  std::size_t triangles;
  double area;                   ///< m²
  std::optional<double> volume;  ///< m³, positive if the triangles face outward; none for an open surface
  Eigen::AlignedBox3d bounding_box;    ///< m, sides along the world's axes
  std::optional<MeshDefects> defects;  ///< of a mesh; none for the other shapes, which have no defects
};

struct SceneInfo {
  std::size_t links;
  std::size_t sensors;
  std::size_t distance_sensors;
  std::size_t triangles;  ///< of all objects
  std::vector<ObjectInfo> objects;
};

/// Collects the counts and the objects' geometry of a scene. Throws InputError for a mesh that is not finite.
SceneInfo scene_info(const Scene& scene);

}  // namespace fringe
