#pragma once

#include <cstddef>
#include <span>

#include <Eigen/Core>

#include "bem/panel.hpp"

/// The double-layer operator of panels with a constant dipole density (model/BOUNDARY_ELEMENTS.md, section
/// 12).
namespace fringe::detail {

/// Returns the solid angle of a triangle seen from a point, over 4π: positive where the triangle's normal, by
/// the order of its corners, points away from the point, and zero in the triangle's plane.
double solid_angle_part(const Triangle& triangle, const Eigen::Vector3d& point);

/// Computes the mean over each target (rows) of the solid angle of each source (columns), over 4π. The jump
/// across a source counts with the mean of both sides. `tolerance` is the absolute error aimed at.
Eigen::MatrixXd double_layer_matrix(std::span<const Panel> targets, std::span<const Panel> sources,
                                    double tolerance, std::size_t threads);

}  // namespace fringe::detail
