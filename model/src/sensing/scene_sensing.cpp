#include "fringe/scene_sensing.hpp"

#include <numbers>
#include <utility>

#include <fmt/format.h>

#include "fringe/error.hpp"
#include "fringe/pose.hpp"
#include "fringe/triangulation.hpp"
#include "geometry/link_motion.hpp"
#include "sensing/triangle_tree.hpp"

namespace fringe {
namespace {

using detail::ConeQuery;

/// Returns the sensor's cone in the world. The angle is divided by 180 first, so that 180° becomes exactly π.
SensingCone placed(const DistanceSensor& sensor, const Eigen::Isometry3d& pose) {
  return {pose * sensor.apex, pose.linear() * sensor.direction.stableNormalized(),
          sensor.full_angle_degrees / 180 * std::numbers::pi, sensor.range};
}

/// An object with the hierarchy of its triangles, and its pose on its link.
struct SensedObject {
  std::string name;
  std::optional<std::size_t> link;
  Eigen::Isometry3d on_link;
  detail::TriangleTree tree;
};

}  // namespace

class SceneSensing::Implementation {
 public:
  Implementation(const Scene& scene, ConeMethod method, std::shared_ptr<detail::LinkPoses> poses)
      : poses_(std::move(poses)), sensors_(scene.distance_sensors), method_(method) {
    for (const Object& object : scene.objects) {
      if (is_cover(object))
        continue;
      try {
        objects_.push_back(
            {object.name, object.link, object.pose, detail::TriangleTree(triangulate(object.shape))});
      } catch (const InputError& error) {
        throw InputError(fmt::format("object \"{}\": {}", object.name, error.what()));
      }
    }
  }

  void set_pose(std::string_view link, const Eigen::Isometry3d& pose) { poses_->set_pose(link, pose); }

  std::vector<DistanceReading> sense() const {
    const std::vector<Eigen::Isometry3d> link_poses = world_poses(poses_->links());
    std::vector<DistanceReading> readings;
    for (const DistanceSensor& sensor : sensors_) {
      try {
        ConeQuery query(placed(sensor, attachment_pose(link_poses, sensor.link)), method_);
        readings.push_back({sensor.name, closest(query, link_poses)});
      } catch (const InputError& error) {
        throw InputError(fmt::format("distance sensor \"{}\": {}", sensor.name, error.what()));
      }
    }
    return readings;
  }

 private:
  /// Searches all objects for the closest visible point.
  std::optional<SensedPoint> closest(ConeQuery& query,
                                     const std::vector<Eigen::Isometry3d>& link_poses) const {
    for (std::size_t i = 0; i < objects_.size(); ++i)
      objects_[i].tree.search(query, attachment_pose(link_poses, objects_[i].link) * objects_[i].on_link, i);
    if (!query.best())
      return std::nullopt;
    const auto& [seen, object] = *query.best();
    return SensedPoint{seen.distance, seen.point, objects_[object].name, seen.triangle};
  }

  std::shared_ptr<detail::LinkPoses> poses_;
  std::vector<DistanceSensor> sensors_;
  std::vector<SensedObject> objects_;
  ConeMethod method_;
};

SceneSensing::SceneSensing(const Scene& scene, ConeMethod method)
    : SceneSensing(scene, method, std::make_shared<detail::LinkPoses>(scene.links)) {}
SceneSensing::SceneSensing(const Scene& scene, ConeMethod method, std::shared_ptr<detail::LinkPoses> poses)
    : implementation_(std::make_unique<Implementation>(scene, method, std::move(poses))) {}
SceneSensing::~SceneSensing() = default;
SceneSensing::SceneSensing(SceneSensing&&) noexcept = default;
SceneSensing& SceneSensing::operator=(SceneSensing&&) noexcept = default;

void SceneSensing::set_pose(std::string_view link, const Eigen::Isometry3d& pose) {
  implementation_->set_pose(link, pose);
}

std::vector<DistanceReading> SceneSensing::sense() const {
  return implementation_->sense();
}

std::vector<DistanceReading> sense(const Scene& scene, ConeMethod method) {
  return SceneSensing(scene, method).sense();
}

}  // namespace fringe
