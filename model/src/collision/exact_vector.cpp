#include "collision/exact_vector.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

namespace fringe::detail {
namespace {

constexpr int digits = std::numeric_limits<double>::digits;

/// Bits of a quotient: enough for its truncation to change the result by a thousandth of a unit in a double's
/// last place.
constexpr int quotient_bits = digits + 11;

/// Returns the number of bits of the magnitude.
int length(const Integer& number) {
  return number.is_zero() ? 0 : static_cast<int>(msb(Integer(abs(number)))) + 1;
}

/// Returns number/2^bits, its magnitude truncated to the digits of a double.
double scaled(const Integer& number, int bits) {
  const int dropped = std::max(0, length(number) - digits);
  const Integer leading = Integer(abs(number)) >> static_cast<unsigned>(dropped);
  const double magnitude =
      std::ldexp(static_cast<double>(static_cast<std::int64_t>(leading)), dropped - bits);
  return number.sign() < 0 ? -magnitude : magnitude;
}

}  // namespace

int common_unit(std::span<const Eigen::Vector3d> points, int at_most) {
  int unit = at_most;
  for (const Eigen::Vector3d& point : points)
    for (const double coordinate : point)
      if (coordinate != 0)
        unit = std::min(unit, std::ilogb(coordinate) + 1 - digits);
  return unit;
}

ExactVector in_units(const Eigen::Vector3d& point, int unit) {
  ExactVector exact;
  for (int i = 0; i < 3; ++i) {
    if (point[i] == 0)
      continue;
    int exponent = 0;
    const double mantissa = std::frexp(point[i], &exponent);
    exact[static_cast<std::size_t>(i)] = static_cast<std::int64_t>(std::ldexp(mantissa, digits));
    exact[static_cast<std::size_t>(i)] <<= static_cast<unsigned>(exponent - digits - unit);
  }
  return exact;
}

ExactVector difference(const ExactVector& a, const ExactVector& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}

ExactVector negated(const ExactVector& vector) {
  return {-vector[0], -vector[1], -vector[2]};
}

Integer dot(const ExactVector& a, const ExactVector& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

Eigen::Vector3d direction_of(const ExactVector& vector) {
  const int bits = std::max({length(vector[0]), length(vector[1]), length(vector[2])});
  return {scaled(vector[0], bits), scaled(vector[1], bits), scaled(vector[2], bits)};
}

double rounded_quotient(const Integer& numerator, const Integer& denominator, int exponent) {
  const int shift = std::max(0, quotient_bits - length(numerator) + length(denominator));
  const Integer quotient = Integer(numerator << static_cast<unsigned>(shift)) / denominator;
  return scaled(quotient, shift - exponent);
}

double rounded_root_quotient(const Integer& square, const Integer& denominator, int exponent) {
  const Integer square_below = denominator * denominator;
  const int half_shift = std::max(0, (2 * quotient_bits - length(square) + length(square_below) + 1) / 2);
  const Integer quotient = Integer(square << static_cast<unsigned>(2 * half_shift)) / square_below;
  return scaled(sqrt(quotient), half_shift - exponent);
}

}  // namespace fringe::detail
