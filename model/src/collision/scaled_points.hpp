#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

namespace fringe::detail {

/// Points in a unit in which their squares neither overflow nor underflow.
struct ScaledPoints {
  std::vector<Eigen::Vector3d> points;  ///< coordinates in [−1, 1], times 2^exponent what was given
  Eigen::Vector3d middle;               ///< of their axis-aligned box
  int exponent;
};

/// Throws InputError for no points and for one that is not finite.
ScaledPoints scaled_points(std::span<const Eigen::Vector3d> points);

}  // namespace fringe::detail
