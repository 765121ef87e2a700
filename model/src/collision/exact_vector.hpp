#pragma once

#include <array>
#include <span>

#include <Eigen/Core>
#include <boost/multiprecision/cpp_int.hpp>

/// Vectors of integers, for what floating point leaves undecided.
namespace fringe::detail {

using Integer = boost::multiprecision::cpp_int;
using ExactVector = std::array<Integer, 3>;

/// The exponent of a power of two of which all coordinates are multiples, `at_most` if they allow more.
int common_unit(std::span<const Eigen::Vector3d> points, int at_most);

/// The point in units of 2^unit, which must be a common unit of its coordinates.
ExactVector in_units(const Eigen::Vector3d& point, int unit);

ExactVector difference(const ExactVector& a, const ExactVector& b);
ExactVector negated(const ExactVector& vector);

Integer dot(const ExactVector& a, const ExactVector& b);

/// The vector times the power of two that brings its largest component to [1/2, 1), each component rounded by
/// less than 2⁻⁵²; zero for zero.
Eigen::Vector3d direction_of(const ExactVector& vector);

/// numerator/denominator·2^exponent, less than one unit in the last place off (above the subnormal numbers).
/// The denominator must be positive.
double rounded_quotient(const Integer& numerator, const Integer& denominator, int exponent);

/// √(square)/denominator·2^exponent, less than two units in the last place off (above the subnormal numbers).
/// The denominator must be positive.
double rounded_root_quotient(const Integer& square, const Integer& denominator, int exponent);

}  // namespace fringe::detail
