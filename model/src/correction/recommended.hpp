#pragma once

#include <cstddef>
#include <optional>
#include <string_view>

#include <Eigen/Geometry>

#include "fringe/reduced_capacitance.hpp"
#include "fringe/scene.hpp"

namespace fringe::detail {

/// The correction `recommended` for a scene whose links move: uses the reduced method where it determines
/// `mutual` more accurately than the formula does (model/CORRECTIONS.md, section 5).
class Recommended {
 public:
  /// Prepares a scene. There are no answers if the reduced method refuses the scene or its meshes would take
  /// too long.
  explicit Recommended(const Scene& scene);

  /// Replaces a link's pose relative to its parent. The link must exist.
  void set_pose(std::string_view link, const Eigen::Isometry3d& pose);

  /// Computes the answer for the current poses; returns whether any pose was set since the last answer.
  bool update();

  /// Returns the capacitance in F, or nothing if the formula is to be used.
  std::optional<double> mutual(std::size_t sensor, std::size_t object) const;

 private:
  std::optional<ReducedEvaluator> evaluator_;
  const MaxwellMatrix* matrix_ = nullptr;  ///< null if there is no answer, as when conductors touch
  bool is_stale_ = true;
};

}  // namespace fringe::detail
