#pragma once

#include <cstddef>

#include "geometry/plate_frame.hpp"
#include "integral/tree/node_bound.hpp"

namespace fringe::detail {

/// For each triangle of a leaf, what the kinks of the distance in the plate's border planes add to the error
/// of its quadrature, at most (m): nothing where no border crosses it. No point of the leaf may be nearer to
/// the plate than nearest_distance, which must be positive.
/// @param points those of all triangles
/// @param errors has room for the leaf's triangles
void border_errors(const PlateFrame& plate, const Placement& placement, const Node& leaf,
                   const PointArrays& points, double* errors);

}  // namespace fringe::detail
