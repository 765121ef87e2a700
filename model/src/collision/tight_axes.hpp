#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

#include "fringe/bounding_volume.hpp"

namespace fringe::detail {

/// Finds the axes (rows) of a box of small volume around the points, whose coordinates must be of the order
/// of one (model/NUMERICS.md, section 13).
Eigen::Matrix3d tight_axes(const std::vector<Eigen::Vector3d>& points, std::span<const Face> faces);

}  // namespace fringe::detail
