#pragma once

#include "geometry/plate_frame.hpp"

namespace fringe::detail {

/// ∫dA/d over a triangle in closed form, one triangle at a time and whatever its shape: it is cut at the
/// plate's border planes, and every piece is integrated in its own cell (model/NUMERICS.md, sections 2 to 7).
double exact_integral(const PlateFrame& plate, const LocalTriangle& triangle, double twice_area);

}  // namespace fringe::detail
