#pragma once

#include <compare>
#include <cstdint>
#include <memory>
#include <utility>

#include <Eigen/Core>
#include <boost/multiprecision/cpp_int.hpp>

/// Exact arithmetic for queries that floating point leaves undecided.
namespace fringe::detail {

template <class Number>
using Vector = Eigen::Matrix<Number, 3, 1>;

/// A number mantissa·2^exponent with integers of any size. Every finite double is one, and sums, differences
/// and products of such numbers are exact.
class Dyadic {
 public:
  /// Integers of any size; those below 2^512 take no memory of their own.
  using Integer = boost::multiprecision::number<boost::multiprecision::cpp_int_backend<
      512, 0, boost::multiprecision::signed_magnitude, boost::multiprecision::unchecked,
      std::allocator<std::uint64_t>>>;

  Dyadic() = default;

  /// Takes the double as it is, which must be finite.
  Dyadic(double value);

  int sign() const { return mantissa_.sign(); }

  Dyadic operator-() const;
  Dyadic& operator+=(const Dyadic& other);

  friend Dyadic operator+(Dyadic a, const Dyadic& b) {
    a += b;
    return a;
  }
  friend Dyadic operator-(const Dyadic& a, const Dyadic& b);
  friend Dyadic operator*(const Dyadic& a, const Dyadic& b);
  friend bool operator==(const Dyadic& a, const Dyadic& b) { return (a - b).sign() == 0; }
  friend std::strong_ordering operator<=>(const Dyadic& a, const Dyadic& b) { return (a - b).sign() <=> 0; }

  /// Returns the least n for which the magnitude is below 2^n. The number must not be zero.
  int magnitude() const;

  /// Rounds the number divided by 2^n towards zero.
  double rounded(int n = 0) const;

  /// Computes the quotient, rounded towards zero. The divisor must be positive.
  friend double rounded_quotient(const Dyadic& dividend, const Dyadic& divisor);

  /// Computes √square/divisor with an error below two units in the last place (above the subnormal numbers).
  /// The divisor must be positive.
  friend double rounded_root_quotient(const Dyadic& square, const Dyadic& divisor);

 private:
  Dyadic(Integer mantissa, int exponent) : mantissa_(std::move(mantissa)), exponent_(exponent) {}

  Integer mantissa_;
  int exponent_ = 0;
};

/// Scales the vector by the power of two that brings its largest component to [1/2, 1), and rounds each
/// component by less than 2⁻⁵² of itself. Returns zero for the zero vector.
Eigen::Vector3d direction_of(const Vector<Dyadic>& vector);

}  // namespace fringe::detail

/// What Eigen must know of a number to use it in vectors.
template <>
struct Eigen::NumTraits<fringe::detail::Dyadic> : Eigen::GenericNumTraits<fringe::detail::Dyadic> {
  enum { IsInteger = 0, IsSigned = 1, RequireInitialization = 1, ReadCost = 10, AddCost = 50, MulCost = 100 };
};
