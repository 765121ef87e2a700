#pragma once

#include "fringe/rectangle.hpp"
#include "fringe/triangle.hpp"

namespace fringe::benchmarks {

/// Computes ∫dA/d over a triangle in metres, to a relative error far below 2^-53, as the reference for the
/// methods' errors. It shares no code with them: it applies quadrature to the distance itself, in extended
/// precision, on parts of the triangle so small, and each within one cell, that the distance is smooth on
/// each.
///
/// The triangle must not touch the plate, and the plate's edges must be along x and y with its corner at the
/// origin, since other plates would add rounding errors of their own.
long double accurate_integral(const Triangle& triangle, const Rectangle& plate);

}  // namespace fringe::benchmarks
