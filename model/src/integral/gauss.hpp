#pragma once

#include "geometry/plate_frame.hpp"
#include "numeric/gauss_rule.hpp"

namespace fringe::detail {

/// Computes ∫dA/d over a triangle by the tensor product of two Gauss rules, collapsed onto the triangle's
/// first vertex (Duffy transformation).
double gauss_integral(const PlateFrame& plate, const LocalTriangle& triangle, double twice_area,
                      const GaussRule& rule);

}  // namespace fringe::detail
