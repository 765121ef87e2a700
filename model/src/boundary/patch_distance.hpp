#pragma once

#include <array>

#include <Eigen/Core>

namespace fringe::detail {

/// The shortest distance between two segments, given by their ends.
double segment_distance(const Eigen::Vector3d& a0, const Eigen::Vector3d& a1, const Eigen::Vector3d& b0,
                        const Eigen::Vector3d& b1);

/// The corners of a rectangle in their order around it.
using Corners = std::array<Eigen::Vector3d, 4>;

/// The shortest distance between a rectangle in z = 0, sides along x and y, and the four edges of another
/// that does not pass through it.
double edge_distance(const Eigen::Vector2d& low, const Eigen::Vector2d& high, const Corners& other);

}  // namespace fringe::detail
