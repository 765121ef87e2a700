#pragma once

#include <memory>
#include <string_view>

#include <Eigen/Geometry>

#include "fringe/evaluation.hpp"
#include "fringe/reading_answer.hpp"
#include "fringe/scene.hpp"

namespace fringe {

namespace detail {
class LinkPoses;
}

/// Evaluates every sensor of a scene repeatedly while links move.
///
/// Only what can have changed is evaluated: a sensor and an object that have not moved relative to each other
/// keep their value. With a tolerance, an object whose contribution is within the tolerance is estimated from
/// its bounding sphere alone, and from the second answer on the others are integrated by a SurfaceTree, which
/// is built when first needed.
class SceneEvaluator {
 public:
  /// Prepares the scene.
  ///
  /// @throws InputError for the scenes that capacitance() refuses.
  explicit SceneEvaluator(const Scene& scene, const EvaluationOptions& options = {});
  /// Prepares the scene for a LiveScene, which owns the poses.
  SceneEvaluator(const Scene& scene, const EvaluationOptions& options,
                 const std::shared_ptr<detail::LinkPoses>& poses);
  ~SceneEvaluator();
  SceneEvaluator(SceneEvaluator&&) noexcept;
  SceneEvaluator& operator=(SceneEvaluator&&) noexcept;
  SceneEvaluator(const SceneEvaluator&) = delete;
  SceneEvaluator& operator=(const SceneEvaluator&) = delete;

  /// Replaces a link's pose relative to its parent.
  /// @throws InputError when no link has the name.
  void set_pose(std::string_view link, const Eigen::Isometry3d& pose);

  /// Computes the answer for the current poses; valid until the next call. Its counts are the work of this
  /// call.
  const SceneCapacitance& capacitance();

  /// Computes the derivatives of an object's capacitance to a sensor as the object moves and the sensor
  /// stays, for the poses of the last capacitance(): in F/m along the world's axes, and in F/rad about those
  /// through the world's origin. For a sensor that moves and an object that stays they have the opposite
  /// sign. All are NaN in contact. Sensor and object are given by their places in the answer. A tolerance
  /// does not apply: every triangle that counts is integrated.
  /// @throws InputError for options other than the method exact without a correction.
  PoseDerivatives derivatives(std::size_t sensor, std::size_t object);

 private:
  class Implementation;
  static std::unique_ptr<Implementation> make_implementation(const Scene& scene,
                                                             const EvaluationOptions& options,
                                                             const std::shared_ptr<detail::LinkPoses>& poses);
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace fringe
