#include "formula/formula.hpp"
#include "formula/layer_rule.hpp"
#include "fringe/capacitance.hpp"
#include "fringe/pose.hpp"
#include "fringe/triangulation.hpp"

namespace fringe {

std::vector<std::vector<FormulaTerms>> formula_terms(const Scene& scene) {
  // Throws for the scenes that the correction refuses.
  capacitance(scene, {.method = Formula{}});
  const Scene bare = detail::without_covers(scene, detail::CoveredPlate::moved);
  const std::vector<Eigen::Isometry3d> link_poses = world_poses(bare.links);
  std::vector<std::vector<FormulaTerms>> result;
  for (const Sensor& sensor : bare.sensors) {
    const Eigen::Isometry3d sensor_pose = attachment_pose(link_poses, sensor.link);
    const detail::ChargedSurface charged_sensor =
        detail::make_charged_surface(detail::plate_triangles(sensor.plates));
    result.emplace_back();
    for (const Object& object : bare.objects) {
      const Eigen::Isometry3d pose = attachment_pose(link_poses, object.link) * object.pose;
      const Eigen::Isometry3d to_object = pose.inverse(Eigen::Isometry) * sensor_pose;
      std::vector<Rectangle> plates;
      for (const Rectangle& plate : sensor.plates)
        plates.push_back(transformed(plate, to_object));
      result.back().push_back(detail::formula_terms(detail::make_charged_surface(triangulate(object.shape)),
                                                    charged_sensor, to_object, plates));
    }
  }
  return result;
}

}  // namespace fringe
