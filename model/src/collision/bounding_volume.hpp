#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

#include "fringe/bounding_volume.hpp"

/// Steps towards bounding volumes: points that are scaled, axes of oriented boxes, and boxes of which the
/// axes are nearly orthonormal.
namespace fringe::detail {

/// Points scaled by a power of two so that their squares neither overflow nor underflow.
struct ScaledPoints {
  std::vector<Eigen::Vector3d> points;  ///< coordinates in [−1, 1]; times 2^exponent, the given ones
  Eigen::Vector3d middle;               ///< centre of the scaled points' axis-aligned box
  int exponent;
};

/// Scales the points. Throws InputError if there are none or if one is not finite.
ScaledPoints scaled_points(std::span<const Eigen::Vector3d> points);

/// Computes the eigenvectors (rows, that of the largest eigenvalue first) of the covariance of the points
/// (thesis 3.1.4.1).
Eigen::Matrix3d axes_of_vertices(const std::vector<Eigen::Vector3d>& points);

/// Computes the same for the surface of the triangles, each weighted by its area (thesis 3.1.4.2). If the
/// triangles have no area, uses the vertices.
Eigen::Matrix3d axes_of_triangles(const std::vector<Eigen::Vector3d>& points, std::span<const Face> faces);

/// Finds the axes (rows) of a box of small volume around the points, whose coordinates must be of the order
/// of one (model/NUMERICS.md, section 13).
Eigen::Matrix3d tight_axes(const std::vector<Eigen::Vector3d>& points, std::span<const Face> faces);

/// Tests boxes for overlap as overlap() does, if their axes are orthonormal only to a tenth of `margin`.
/// False means that they are apart by more than the margin times the sum of all lengths.
bool overlap_within(const OrientedBox& a, const OrientedBox& b, double margin);

}  // namespace fringe::detail
