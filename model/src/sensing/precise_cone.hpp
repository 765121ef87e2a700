#pragma once

#include "numeric/precise_vector.hpp"

namespace fringe::detail {

/// The cone of a distance sensor with its half angle enlarged by `boundary_width`; all decisions use this
/// one.
struct PreciseCone {
  PreciseVector axis;   ///< of length 1
  DoubleDouble cosine;  ///< of the half angle; negative if the half angle was enlarged beyond 90°
  DoubleDouble sine;
};

/// Angle in radians by which the half angle is enlarged, so that a point counts as inside if only rounding
/// puts it outside. Directions, angles, and vertices as large as their distance each have errors of about
/// 2^−53.
inline constexpr double boundary_width = 0x1p-50;

/// Relative rounding error of a double-double after some dozen operations, with room to spare.
inline constexpr double precise_noise = 0x1p-90;

/// Computes the cone for a finite direction that is not zero.
PreciseCone precise_cone(const Eigen::Vector3d& direction, double full_angle);

}  // namespace fringe::detail
