#pragma once

#include <array>

#include <Eigen/Core>

namespace fringe::detail {

/// The nearest points of two segments, given by their ends, as fractions of the way along each.
struct NearestParts {
  double a;
  double b;
};
NearestParts nearest_parts(const Eigen::Vector3d& a0, const Eigen::Vector3d& a1, const Eigen::Vector3d& b0,
                           const Eigen::Vector3d& b1);

/// Returns the shortest distance between two segments, given by their ends.
double segment_distance(const Eigen::Vector3d& a0, const Eigen::Vector3d& a1, const Eigen::Vector3d& b0,
                        const Eigen::Vector3d& b1);

/// The corners of a rectangle in their order around it.
using RectangleCorners = std::array<Eigen::Vector3d, 4>;

/// Returns the shortest distance between a rectangle in z = 0, with sides along x and y, and the
/// singularities along one axis, 0 or 1, of another rectangle's potential: its corners, and its edges that
/// are not parallel to the axis. The other rectangle must not pass through the first.
double edge_distance(const Eigen::Vector2d& low, const Eigen::Vector2d& high, Eigen::Index axis,
                     const RectangleCorners& other);

}  // namespace fringe::detail
