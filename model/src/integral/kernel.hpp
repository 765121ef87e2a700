#pragma once

#include <Eigen/Core>

namespace fringe::detail {

/// K(v₀, v₁, v₂) = ∫ dλ/|λ₀v₀ + λ₁v₁ + λ₂v₂| over the simplex of barycentric coordinates, whose area is 1/2
/// (model/NUMERICS.md, section 2). The triangle of the three vectors may be flat, a segment or a point.
/// +infinity when the integral diverges.
double kernel(const Eigen::Vector3d& v0, const Eigen::Vector3d& v1, const Eigen::Vector3d& v2);

/// The kernel of three vectors along one line, given by their signed lengths (region I; thesis 5.3.1 and
/// appendix D).
double kernel_of_heights(double z0, double z1, double z2);

/// The kernel of three vectors from the plate's nearest points (from_plate). Where all of them stand on the
/// plate's plane, be it above the plate or above its edge, the heights alone decide whether there is contact.
double kernel_from_plate(const Eigen::Vector3d& v0, const Eigen::Vector3d& v1, const Eigen::Vector3d& v2);

}  // namespace fringe::detail
