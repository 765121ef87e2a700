#pragma once

#include <memory>
#include <string_view>

#include <Eigen/Geometry>

#include "fringe/capacitance.hpp"
#include "fringe/scene.hpp"

namespace fringe {

/// What every sensor of a scene feels, answered again and again while links move.
///
/// Only what can have changed is evaluated: a pair of a sensor and an object whose poses relative to each
/// other are as they were keeps its value. With a tolerance, objects whose contribution the tolerance covers
/// are enclosed by their bounding sphere alone, and from the second answer on the others are integrated by a
/// SurfaceTree, made when it is first needed.
class SceneEvaluator {
 public:
  /// @throws InputError for what capacitance() refuses.
  explicit SceneEvaluator(const Scene& scene, const CapacitanceOptions& options = {});
  ~SceneEvaluator();
  SceneEvaluator(SceneEvaluator&&) noexcept;
  SceneEvaluator& operator=(SceneEvaluator&&) noexcept;
  SceneEvaluator(const SceneEvaluator&) = delete;
  SceneEvaluator& operator=(const SceneEvaluator&) = delete;

  /// Replaces a link's pose relative to its parent.
  /// @throws InputError when no link has the name.
  void set_pose(std::string_view link, const Eigen::Isometry3d& pose);

  /// The answer for the poses as they are; valid until the next call. Its counts are the work of this call.
  const SceneCapacitance& capacitance();

 private:
  class Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace fringe
