#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "fringe/plate_integral.hpp"
#include "fringe/rectangle.hpp"
#include "fringe/triangle_batch.hpp"

namespace fringe {

/// A sum of integrals and a bound of its error.
struct BoundedIntegral {
  double value;  ///< m
  double bound;  ///< m; the true sum is within bound of value, besides rounding
};

/// Computes ∫dA/d over each triangle (plate_integral), in their order.
///
/// Each triangle is integrated by the cheapest rule that meets the tolerance: far from the plate a symmetric
/// quadrature rule with a proven error bound, in front of the plate and near it a closed form
/// (model/NUMERICS.md, section 12).
///
/// @param triangles prepared once for any number of plates
/// @param plate the rectangle from which distances are taken
/// @param tolerance largest relative error of each triangle's integral, besides rounding; 0: full precision
/// @param threads largest number of threads; 0: as many as the machine offers. The results do not depend on
/// it, bit by bit.
/// @throws InputError when the plate is not a rectangle or the tolerance is negative or not finite.
std::vector<double> plate_integrals(const TriangleBatch& triangles, const Rectangle& plate,
                                    double tolerance = 0, int threads = 0);

/// Computes the sum of the integrals over all triangles, for each plate.
std::vector<BoundedIntegral> total_integrals(const TriangleBatch& triangles,
                                             std::span<const Rectangle> plates, double tolerance = 0,
                                             int threads = 0);

/// Computes the derivatives of the sum of the integrals as all triangles move together and the plate stays,
/// as plate_integral_derivatives does for one. Throws InputError when the plate is not a rectangle.
IntegralDerivatives total_derivatives(const TriangleBatch& triangles, const Rectangle& plate);

}  // namespace fringe
