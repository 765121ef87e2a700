#pragma once

#include <cstddef>

#include "geometry/plate_frame.hpp"
#include "integral/tree/node_bound.hpp"

namespace fringe::detail {

/// Bounds, for each triangle of a leaf, the quadrature error (m) that the kinks of the distance in the
/// plate's border planes cause: 0 where no border plane crosses the triangle. nearest_distance of the leaf
/// must be positive.
/// @param points quadrature points of all triangles of the tree
/// @param errors one element per triangle of the leaf
void border_errors(const PlateFrame& plate, const Placement& placement, const Node& leaf,
                   const PointArrays& points, double* errors);

}  // namespace fringe::detail
