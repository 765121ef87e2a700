#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

namespace fringe::detail {

/// The vertices of a convex part of a body.
using ConvexHull = std::vector<Eigen::Vector3d>;

/// Returns true if any part of one body has a point in common with any part of the other; the test is exact.
bool hulls_meet(std::span<const ConvexHull> a, std::span<const ConvexHull> b);

}  // namespace fringe::detail
