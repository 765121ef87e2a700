#pragma once

#include "fringe/convex_shape.hpp"

/// The search for shapes with round surfaces that the quick search left (model/NUMERICS.md, section 13).
namespace fringe::detail {

/// Begins with the points that were reached. `pose_a` and `pose_b` are rotations to 1e-9.
ShapeAnswer round_search(const ConvexShape& a, const Eigen::Isometry3d& pose_a, const ConvexShape& b,
                         const Eigen::Isometry3d& pose_b, const PointSimplex& reached);

}  // namespace fringe::detail
