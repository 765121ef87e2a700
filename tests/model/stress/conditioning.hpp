#pragma once

#include "sectors.hpp"

namespace fringe::stress {

/// The largest relative change of ∫dA/d when one of the 18 numbers that describe a triangle and a plate moves
/// by one unit in its last place, to two digits or an underestimate: what no method that works in doubles can
/// be expected to see. `value` is the integral, finite and positive.
///
/// From the derivatives of the integral under the integral sign. Where the triangle comes as close to the
/// plate as the units in the last place themselves, distances are taken larger than they are.
double conditioning(const Dissection& dissection, const Triangle& triangle, const Rectangle& plate,
                    double value);

}  // namespace fringe::stress
