#pragma once

#include "graded_rule.hpp"
#include "numeric/double_double.hpp"

namespace fringe::stress {

using detail::DoubleDouble;

struct DoubleDoubleVector {
  DoubleDouble x, y, z;
};

inline DoubleDoubleVector operator+(const DoubleDoubleVector& a, const DoubleDoubleVector& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}

inline DoubleDoubleVector operator*(DoubleDouble factor, const DoubleDoubleVector& vector) {
  return {factor * vector.x, factor * vector.y, factor * vector.z};
}

/// Side lengths of the plate 0 ≤ x ≤ u, 0 ≤ y ≤ v, z = 0.
struct PlateExtent {
  DoubleDouble u, v;
};

/// Computes ∫₀¹ s ds/d(apex + s·ray) by a quadrature rule, where d is the distance to the plate.
DoubleDouble row_sum(const DoubleDoubleVector& apex, const DoubleDoubleVector& ray, const PlateExtent& extent,
                     const Rule& rule);

}  // namespace fringe::stress
