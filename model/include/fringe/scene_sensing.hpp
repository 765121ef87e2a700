#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Geometry>

#include "fringe/distance_sensor.hpp"
#include "fringe/scene.hpp"

namespace fringe {

namespace detail {
class LinkPoses;
}

/// A point of an object that a distance sensor sees.
struct SensedPoint {
  double distance;        ///< m
  Eigen::Vector3d point;  ///< m, in the world frame
  std::string object;
  std::size_t triangle;  ///< the index among the object's triangles, as in conductors()
};

/// The reading of one distance sensor of a scene.
struct DistanceReading {
  std::string name;
  std::optional<SensedPoint> closest;  ///< none if nothing is in its cone
};

/// Evaluates the distance sensors of a scene repeatedly while links move. The sensors see every object, of
/// whatever material and also on their own link, but neither each other nor the plates of capacitive sensors.
/// Each object's bounding volume hierarchy is built once.
class SceneSensing {
 public:
  /// Prepares the scene. Throws InputError for an object that is not finite.
  explicit SceneSensing(const Scene& scene, ConeMethod method = ConeMethod::field_of_view);
  /// Prepares the scene for a LiveScene, which owns the poses.
  SceneSensing(const Scene& scene, ConeMethod method, std::shared_ptr<detail::LinkPoses> poses);
  ~SceneSensing();
  SceneSensing(SceneSensing&&) noexcept;
  SceneSensing& operator=(SceneSensing&&) noexcept;
  SceneSensing(const SceneSensing&) = delete;
  SceneSensing& operator=(const SceneSensing&) = delete;

  /// Replaces a link's pose relative to its parent. Throws InputError when no link has the name.
  void set_pose(std::string_view link, const Eigen::Isometry3d& pose);

  /// Computes the readings for the current poses, the sensors in the scene's order; among equally near
  /// objects the first one counts. The result is to the last bit what cone_closest finds on the conductors()
  /// of the scene. Throws InputError for poses that lead beyond the range of doubles.
  std::vector<DistanceReading> sense() const;

 private:
  class Implementation;
  std::unique_ptr<Implementation> implementation_;
};

/// Evaluates the distance sensors once, for a scene as it is.
std::vector<DistanceReading> sense(const Scene& scene, ConeMethod method = ConeMethod::field_of_view);

}  // namespace fringe
