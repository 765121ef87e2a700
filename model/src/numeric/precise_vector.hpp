#pragma once

#include <array>

#include <Eigen/Core>

#include "numeric/double_double.hpp"

/// Vectors of double-doubles.
namespace fringe::detail {

struct PreciseVector {
  DoubleDouble x, y, z;
};

inline PreciseVector operator+(const PreciseVector& a, const PreciseVector& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}

inline PreciseVector operator-(const PreciseVector& a) {
  return {-a.x, -a.y, -a.z};
}

inline PreciseVector operator-(const PreciseVector& a, const PreciseVector& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}

inline PreciseVector operator*(DoubleDouble factor, const PreciseVector& a) {
  return {factor * a.x, factor * a.y, factor * a.z};
}

inline PreciseVector operator*(double factor, const PreciseVector& a) {
  return {factor * a.x, factor * a.y, factor * a.z};
}

inline DoubleDouble dot(const PreciseVector& a, const PreciseVector& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}

inline PreciseVector cross(const PreciseVector& a, const PreciseVector& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

/// Computes a − b without error.
inline PreciseVector exact_difference(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return {exact_sum(a.x(), -b.x()), exact_sum(a.y(), -b.y()), exact_sum(a.z(), -b.z())};
}

inline Eigen::Vector3d rounded(const PreciseVector& a) {
  return {a.x.high, a.y.high, a.z.high};
}

/// The length of a vector and its direction, a unit vector; a vector of length 0 has no direction.
struct Polar {
  DoubleDouble length;
  PreciseVector direction;
};

/// Normalises a vector.
inline Polar polar(const PreciseVector& a) {
  const DoubleDouble square = dot(a, a);
  if (!(square.high > 0))
    return {{}, {}};
  const DoubleDouble inverse = inverse_square_root(square);
  return {square * inverse, inverse * a};
}

}  // namespace fringe::detail
