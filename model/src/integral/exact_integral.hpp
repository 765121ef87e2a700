#pragma once

#include "geometry/plate_frame.hpp"

namespace fringe::detail {

/// Computes ∫dA/d over one triangle of any shape in closed form. Cuts the triangle at the plate's border
/// planes and integrates every piece in its own cell (model/NUMERICS.md, sections 2 to 7).
double exact_integral(const PlateFrame& plate, const LocalTriangle& triangle, double twice_area);

}  // namespace fringe::detail
