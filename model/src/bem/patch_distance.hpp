#pragma once

#include <array>

#include <Eigen/Core>

namespace fringe::detail {

/// The points of two segments, given by their ends, that are nearest to each other, as parts of the way.
struct NearestParts {
  double a;
  double b;
};
NearestParts nearest_parts(const Eigen::Vector3d& a0, const Eigen::Vector3d& a1, const Eigen::Vector3d& b0,
                           const Eigen::Vector3d& b1);

/// The shortest distance between two segments, given by their ends.
double segment_distance(const Eigen::Vector3d& a0, const Eigen::Vector3d& a1, const Eigen::Vector3d& b0,
                        const Eigen::Vector3d& b1);

/// The corners of a rectangle in their order around it.
using RectangleCorners = std::array<Eigen::Vector3d, 4>;

/// The shortest distance between a rectangle in z = 0, sides along x and y, and what the potential of another
/// that does not pass through it is singular at along one axis, 0 or 1: its corners, and its edges that are
/// not parallel to the axis.
double edge_distance(const Eigen::Vector2d& low, const Eigen::Vector2d& high, Eigen::Index axis,
                     const RectangleCorners& other);

}  // namespace fringe::detail
