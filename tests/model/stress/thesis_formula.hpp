#pragma once

#include "fringe/rectangle.hpp"
#include "fringe/triangle.hpp"

namespace fringe::stress {

/// Computes ∫dA/d over a triangle in region I by the formula printed in thesis 5.3.1 and appendix D, without
/// ε, in double precision and without any safeguards.
double thesis_formula(const Triangle& triangle, const Rectangle& plate);

}  // namespace fringe::stress
