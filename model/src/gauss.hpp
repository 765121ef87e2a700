#pragma once

#include <vector>

#include "gauss_node.hpp"
#include "plate_frame.hpp"

namespace fringe::detail {

using GaussRule = std::vector<GaussNode>;

/// The Gauss–Legendre rule on [0, 1].
GaussRule gauss_rule(int points);

/// ∫dA/d over a triangle by the product of two Gauss rules, collapsed onto the triangle's first vertex
/// (Duffy).
double gauss_integral(const PlateFrame& plate, const LocalTriangle& triangle, double twice_area,
                      const GaussRule& rule);

}  // namespace fringe::detail
