#include "numeric/dyadic.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>

namespace fringe::detail {
namespace {

using Integer = Dyadic::Integer;

constexpr int double_digits = std::numeric_limits<double>::digits;

/// Bits of a quotient, more than a double has: cutting off the rest then changes no rounding towards zero.
constexpr int quotient_bits = double_digits + 11;

/// Returns the number of bits of the magnitude.
int bit_length(const Integer& number) {
  return number.is_zero() ? 0 : static_cast<int>(msb(Integer(abs(number)))) + 1;
}

}  // namespace

Dyadic::Dyadic(double value) {
  if (value == 0)
    return;
  const double fraction = std::frexp(value, &exponent_);
  const auto integer = static_cast<std::int64_t>(std::ldexp(fraction, double_digits));
  // Without its even factors the integer is as short as possible.
  const int even = std::countr_zero(static_cast<std::uint64_t>(integer));
  mantissa_ = integer >> even;
  exponent_ += even - double_digits;
}

Dyadic Dyadic::operator-() const {
  return {-mantissa_, exponent_};
}

Dyadic& Dyadic::operator+=(const Dyadic& other) {
  if (other.sign() == 0)
    return *this;
  if (sign() == 0)
    return *this = other;
  const int shift = other.exponent_ - exponent_;
  if (shift == 0) {
    mantissa_ += other.mantissa_;
  } else if (shift > 0) {
    mantissa_ += other.mantissa_ << shift;
  } else {
    mantissa_ <<= -shift;
    mantissa_ += other.mantissa_;
    exponent_ = other.exponent_;
  }
  return *this;
}

Dyadic operator-(const Dyadic& a, const Dyadic& b) {
  Dyadic difference = -b;
  difference += a;
  return difference;
}

Dyadic operator*(const Dyadic& a, const Dyadic& b) {
  return {a.mantissa_ * b.mantissa_, a.exponent_ + b.exponent_};
}

int Dyadic::magnitude() const {
  return bit_length(mantissa_) + exponent_;
}

double Dyadic::rounded(int n) const {
  if (sign() == 0)
    return 0;
  const int dropped = std::max(0, bit_length(mantissa_) - double_digits);
  const Integer leading = Integer(abs(mantissa_)) >> static_cast<unsigned>(dropped);
  const double size =
      std::ldexp(static_cast<double>(static_cast<std::int64_t>(leading)), dropped + exponent_ - n);
  return sign() < 0 ? -size : size;
}

double rounded_quotient(const Dyadic& dividend, const Dyadic& divisor) {
  const int shift =
      std::max(0, quotient_bits - bit_length(dividend.mantissa_) + bit_length(divisor.mantissa_));
  const Integer quotient = Integer(dividend.mantissa_ << static_cast<unsigned>(shift)) / divisor.mantissa_;
  return Dyadic(quotient, dividend.exponent_ - divisor.exponent_ - shift).rounded();
}

double rounded_root_quotient(const Dyadic& square, const Dyadic& divisor) {
  const Integer squared_divisor = divisor.mantissa_ * divisor.mantissa_;
  const int wanted = 2 * quotient_bits - bit_length(square.mantissa_) + bit_length(squared_divisor) + 1;
  // The quotient's exponent must be even for its root.
  const int even = std::max(0, wanted / 2) * 2, shift = even + (square.exponent_ & 1);
  const Integer quotient = Integer(square.mantissa_ << static_cast<unsigned>(shift)) / squared_divisor;
  return Dyadic(sqrt(quotient), (square.exponent_ - shift) / 2 - divisor.exponent_).rounded();
}

Eigen::Vector3d direction_of(const Vector<Dyadic>& vector) {
  int magnitude = std::numeric_limits<int>::min();
  for (const Dyadic& component : vector)
    if (component.sign() != 0)
      magnitude = std::max(magnitude, component.magnitude());
  return {vector.x().rounded(magnitude), vector.y().rounded(magnitude), vector.z().rounded(magnitude)};
}

}  // namespace fringe::detail
