#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "fringe/rectangle.hpp"
#include "fringe/triangle_batch.hpp"

namespace fringe {

struct BatchOptions {
  /// Largest relative error of each triangle's integral, beside rounding. 0: full precision.
  double tolerance = 0;

  /// How many threads to use at most; 0: as many as the machine offers. The results are the same bit by bit.
  int threads = 0;
};

/// A sum of integrals with what is known about its error.
struct BoundedIntegral {
  double value;  ///< m
  double bound;  ///< m; the true sum is within bound of value, beside rounding
};

/// ∫dA/d over each triangle (plate_integral), in their order.
///
/// Each triangle is integrated by what is cheapest within the tolerance: a symmetric rule whose error has a
/// proven bound far from the plate, a closed form in front of it and near it (model/NUMERICS.md, section 12).
///
/// @throws InputError when the plate is not a rectangle or the tolerance is negative or not finite.
std::vector<double> plate_integrals(const TriangleBatch& triangles, const Rectangle& plate,
                                    const BatchOptions& options = {});

/// The sum of the integrals over all triangles, for each plate.
std::vector<BoundedIntegral> total_integrals(const TriangleBatch& triangles,
                                             std::span<const Rectangle> plates,
                                             const BatchOptions& options = {});

}  // namespace fringe
