#pragma once

#include <span>

#include "fringe/triangle.hpp"

namespace fringe::detail {

/// Returns whether a closed surface encloses a point that is not on it, by the winding number.
bool is_in_polyhedron(std::span<const Triangle> surface, const Eigen::Vector3d& point);

}  // namespace fringe::detail
