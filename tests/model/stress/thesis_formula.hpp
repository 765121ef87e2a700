#pragma once

#include "fringe/rectangle.hpp"
#include "fringe/triangle.hpp"

namespace fringe::stress {

/// ∫dA/d over a triangle in region I by the formula that thesis 5.3.1 and appendix D print, without ε, in
/// doubles and with no precaution added.
double thesis_formula(const Triangle& triangle, const Rectangle& plate);

}  // namespace fringe::stress
