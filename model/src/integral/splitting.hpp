#pragma once

#include "geometry/plate_frame.hpp"

namespace fringe::detail {

/// Computes ∫dA/d over a triangle by the thesis' own method (5.3.2, 5.3.3): divides it into 4^levels
/// congruent triangles and uses the distance of each one's centroid.
double split_integral(const PlateFrame& plate, const LocalTriangle& triangle, double twice_area, int levels);

}  // namespace fringe::detail
