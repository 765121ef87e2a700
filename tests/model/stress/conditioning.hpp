#pragma once

#include "sectors.hpp"

namespace fringe::stress {

/// Computes the largest relative change of ∫dA/d when one of the 18 numbers that describe a triangle and a
/// plate changes by one unit in its last place, to two digits or as an underestimate. No method in double
/// precision can be expected to be more accurate. `value` is the integral, finite and positive.
///
/// Differentiates under the integral sign. Where the triangle is as close to the plate as the units in the
/// last place themselves, distances are taken larger than they are.
double conditioning(const Dissection& dissection, const Triangle& triangle, const Rectangle& plate,
                    double value);

}  // namespace fringe::stress
