#pragma once

#include "sensing/precise_vector.hpp"

namespace fringe::detail {

/// The cone of a distance sensor as it is decided upon: half of its angle enlarged by `boundary_width`.
struct PreciseCone {
  PreciseVector axis;   ///< of length 1
  DoubleDouble cosine;  ///< of the half angle; below 0 when it was enlarged beyond 90°
  DoubleDouble sine;
};

/// Radians: what lies on the boundary but for rounding is inside. Directions, angles and vertices of the size
/// of their distance are each off by up to 2^−53 or so.
inline constexpr double boundary_width = 0x1p-50;

/// What remains of a double-double after some dozen operations, with room to spare.
inline constexpr double precise_noise = 0x1p-90;

/// For a finite direction that is not zero.
PreciseCone precise_cone(const Eigen::Vector3d& direction, double full_angle);

}  // namespace fringe::detail
