#include "fringe/conductors.hpp"

#include <algorithm>

#include "fringe/pose.hpp"
#include "fringe/triangulation.hpp"

namespace fringe {

std::vector<Conductor> conductors(const Scene& scene) {
  const std::vector<Eigen::Isometry3d> link_poses = world_poses(scene.links);
  std::vector<Conductor> result;
  for (const Sensor& sensor : scene.sensors) {
    const Eigen::Isometry3d pose = attachment_pose(link_poses, sensor.link);
    Conductor conductor{sensor.name, {}};
    for (const Rectangle& plate : sensor.plates) {
      const auto& [corner, u, v] = transformed(plate, pose);
      conductor.triangles.push_back({corner, corner + u, corner + u + v});
      conductor.triangles.push_back({corner, corner + u + v, corner + v});
    }
    result.push_back(std::move(conductor));
  }
  for (const Object& object : scene.objects) {
    const Eigen::Isometry3d pose = attachment_pose(link_poses, object.link) * object.pose;
    Conductor conductor{object.name, triangulate(object.shape)};
    for (Triangle& triangle : conductor.triangles)
      triangle = transformed(triangle, pose);
    result.push_back(std::move(conductor));
  }
  return result;
}

}  // namespace fringe
