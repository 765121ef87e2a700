#pragma once

#include <Eigen/Core>

namespace fringe::detail {

/// Computes the kernel K(v₀, v₁, v₂) = ∫ dλ/|λ₀v₀ + λ₁v₁ + λ₂v₂| over the simplex of barycentric coordinates,
/// whose area is 1/2 (model/NUMERICS.md, section 2). The triangle of the three vectors may degenerate to a
/// segment or a point. Returns +infinity when the integral diverges.
double kernel(const Eigen::Vector3d& v0, const Eigen::Vector3d& v1, const Eigen::Vector3d& v2);

/// Computes the kernel of three collinear vectors, given by their signed lengths along the common line
/// (region I; thesis 5.3.1 and appendix D).
double kernel_of_heights(double z0, double z1, double z2);

/// Computes the kernel of three vectors from the plate's nearest points (from_plate). When all three are
/// parallel to the plate's normal, above the plate's interior or its edge, contact is decided by the heights
/// alone.
double kernel_from_plate(const Eigen::Vector3d& v0, const Eigen::Vector3d& v1, const Eigen::Vector3d& v2);

}  // namespace fringe::detail
