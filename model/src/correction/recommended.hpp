#pragma once

#include <cstddef>
#include <optional>
#include <string_view>

#include <Eigen/Geometry>

#include "fringe/reduced_capacitance.hpp"
#include "fringe/scene.hpp"

namespace fringe::detail {

/// The correction `recommended` of a scene that moves: the reduced method, where it knows `mutual` better
/// than the formula does (model/CORRECTIONS.md, section 5).
class Recommended {
 public:
  /// A scene that the reduced method refuses, or whose bodies of triangles cost too much, gets no answers.
  explicit Recommended(const Scene& scene);

  /// Replaces a link's pose relative to its parent. The link must exist.
  void set_pose(std::string_view link, const Eigen::Isometry3d& pose);

  /// Answers for the poses as they are; returns whether anything was asked since the last answer.
  bool update();

  /// F; none where the formula is to be asked.
  std::optional<double> mutual(std::size_t sensor, std::size_t object) const;

 private:
  std::optional<ReducedEvaluator> evaluator_;
  const MaxwellMatrix* matrix_ = nullptr;  ///< none for conductors that touch
  bool is_stale_ = true;
};

}  // namespace fringe::detail
