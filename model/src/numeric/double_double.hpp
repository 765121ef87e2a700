#pragma once

#include <array>
#include <cmath>

#include <Eigen/Core>

/// Double-double arithmetic, and vectors of it: numbers of 106 bits as unevaluated sums of two doubles, for
/// innermost loops where arbitrary precision would take ten times as long (T. J. Dekker, Numerische
/// Mathematik 18, 1971; error bounds in Joldes, Muller and Popescu, ACM Transactions on Mathematical Software
/// 44, 2017).
namespace fringe::detail {

struct DoubleDouble {
  double high = 0;
  double low = 0;  ///< at most half a unit in the last place of `high`
};

/// Computes a + b without error, for |a| ≥ |b|.
inline DoubleDouble quick_sum(double a, double b) {
  const double sum = a + b;
  return {sum, b - (sum - a)};
}

/// Computes a + b without error.
inline DoubleDouble exact_sum(double a, double b) {
  const double sum = a + b;
  const double b_part = sum - a;
  return {sum, (a - (sum - b_part)) + (b - b_part)};
}

/// Computes a·b without error.
inline DoubleDouble exact_product(double a, double b) {
  const double product = a * b;
  return {product, std::fma(a, b, -product)};
}

/// Computes the sum with a relative error of at most 3·2^−106, also under cancellation.
inline DoubleDouble operator+(DoubleDouble a, DoubleDouble b) {
  const DoubleDouble high = exact_sum(a.high, b.high), low = exact_sum(a.low, b.low);
  const DoubleDouble sum = quick_sum(high.high, high.low + low.high);
  return quick_sum(sum.high, sum.low + low.low);
}

inline DoubleDouble operator-(DoubleDouble a) {
  return {-a.high, -a.low};
}

inline DoubleDouble operator-(DoubleDouble a, DoubleDouble b) {
  return a + -b;
}

inline DoubleDouble operator*(DoubleDouble a, DoubleDouble b) {
  const DoubleDouble product = exact_product(a.high, b.high);
  return quick_sum(product.high, product.low + std::fma(a.high, b.low, a.low * b.high));
}

inline DoubleDouble operator*(double a, DoubleDouble b) {
  const DoubleDouble product = exact_product(a, b.high);
  return quick_sum(product.high, std::fma(a, b.low, product.low));
}

/// Computes the quotient with a relative error of at most 10·2^−106, by long division: the remainder of each
/// step gives the next digit.
inline DoubleDouble operator/(DoubleDouble a, DoubleDouble b) {
  const double first = a.high / b.high;
  const DoubleDouble rest = a - first * b;
  const double second = rest.high / b.high;
  const double third = (rest - second * b).high / b.high;
  return quick_sum(first, second) + DoubleDouble{third, 0};
}

/// Computes 1/√a by one Newton step from the double-precision value, whose error it squares.
inline DoubleDouble inverse_square_root(DoubleDouble a) {
  const double guess = 1 / std::sqrt(a.high);
  const DoubleDouble square = exact_product(guess, guess);
  const DoubleDouble residual = DoubleDouble{1, 0} - a * square;
  return quick_sum(guess, 0.5 * guess * residual.high);
}

/// Computes √a for a ≥ 0.
inline DoubleDouble square_root(DoubleDouble a) {
  return a.high == 0 ? DoubleDouble{} : a * inverse_square_root(a);
}

inline bool operator<(DoubleDouble a, DoubleDouble b) {
  return a.high < b.high || (a.high == b.high && a.low < b.low);
}

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
