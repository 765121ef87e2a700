#pragma once

#include "geometry/plate_frame.hpp"
#include "numeric/gauss_rule.hpp"

namespace fringe::detail {

/// ∫dA/d over a triangle by the product of two Gauss rules, collapsed onto the triangle's first vertex
/// (Duffy).
double gauss_integral(const PlateFrame& plate, const LocalTriangle& triangle, double twice_area,
                      const GaussRule& rule);

}  // namespace fringe::detail
