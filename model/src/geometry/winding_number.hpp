#pragma once

#include <span>

#include "fringe/triangle.hpp"

namespace fringe::detail {

/// Whether a point off a closed surface is enclosed by it.
bool surrounds(std::span<const Triangle> surface, const Eigen::Vector3d& point);

}  // namespace fringe::detail
