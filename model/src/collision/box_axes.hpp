#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

#include "fringe/bounding_volume.hpp"

/// Axes of oriented boxes.
namespace fringe::detail {

/// Computes the eigenvectors (rows, that of the largest eigenvalue first) of the covariance of the points
/// (thesis 3.1.4.1).
Eigen::Matrix3d axes_of_vertices(const std::vector<Eigen::Vector3d>& points);

/// Computes the same for the surface of the triangles, each weighted by its area (thesis 3.1.4.2). If the
/// triangles have no area, uses the vertices.
Eigen::Matrix3d axes_of_triangles(const std::vector<Eigen::Vector3d>& points, std::span<const Face> faces);

/// Finds the axes (rows) of a box of small volume around the points, whose coordinates must be of the order
/// of one (model/NUMERICS.md, section 13).
Eigen::Matrix3d tight_axes(const std::vector<Eigen::Vector3d>& points, std::span<const Face> faces);

}  // namespace fringe::detail
