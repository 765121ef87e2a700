#pragma once

#include "fringe/rectangle.hpp"
#include "fringe/triangle.hpp"

namespace fringe::benchmarks {

/// ∫dA/d over a triangle in metres, to a relative error far below 2^-53: what the methods' errors are
/// measured against. It shares nothing with them: quadrature of the distance itself in extended precision, on
/// parts of the triangle so small and so far from each other's cells that the distance is smooth on each.
///
/// The triangle must keep away from the plate, and the plate's edges must be along x and y with its corner in
/// the origin: other plates would bring rounding of their own.
long double accurate_integral(const Triangle& triangle, const Rectangle& plate);

}  // namespace fringe::benchmarks
