#pragma once

#include "geometry/plate_frame.hpp"

namespace fringe::detail {

/// ∫dA/d over a triangle by the thesis' own method (5.3.2, 5.3.3): 4^levels equal triangles, each counted
/// with the distance of its centroid.
double split_integral(const PlateFrame& plate, const LocalTriangle& triangle, double twice_area, int levels);

}  // namespace fringe::detail
