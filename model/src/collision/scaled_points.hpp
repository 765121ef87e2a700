#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

namespace fringe::detail {

/// Points scaled by a power of two so that their squares neither overflow nor underflow.
struct ScaledPoints {
  std::vector<Eigen::Vector3d> points;  ///< coordinates in [−1, 1]; times 2^exponent, the given ones
  Eigen::Vector3d middle;               ///< centre of the scaled points' axis-aligned box
  int exponent;
};

/// Scales the points. Throws InputError if there are none or if one is not finite.
ScaledPoints scaled_points(std::span<const Eigen::Vector3d> points);

}  // namespace fringe::detail
