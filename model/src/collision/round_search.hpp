#pragma once

#include "fringe/convex_shape.hpp"

/// The GJK search for shapes with round surfaces that the filter left undecided (model/NUMERICS.md, section
/// 13).
namespace fringe::detail {

/// Decides whether two shapes intersect, starting from the simplex that the filter reached. `pose_a` and
/// `pose_b` must be rotations to 1e-9.
ShapeAnswer round_search(const ConvexShape& a, const Eigen::Isometry3d& pose_a, const ConvexShape& b,
                         const Eigen::Isometry3d& pose_b, const PointSimplex& reached);

}  // namespace fringe::detail
