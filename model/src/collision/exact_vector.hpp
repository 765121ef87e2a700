#pragma once

#include <array>
#include <span>

#include <Eigen/Core>
#include <boost/multiprecision/cpp_int.hpp>

/// Vectors of integers, for queries that floating point leaves undecided.
namespace fringe::detail {

using Integer = boost::multiprecision::cpp_int;
using ExactVector = std::array<Integer, 3>;

/// Returns the largest exponent of a power of two of which all coordinates are multiples, but no more than
/// `at_most`.
int common_unit(std::span<const Eigen::Vector3d> points, int at_most);

/// Converts a point to units of 2^unit, which must be a common unit of its coordinates.
ExactVector in_units(const Eigen::Vector3d& point, int unit);

ExactVector difference(const ExactVector& a, const ExactVector& b);
ExactVector negated(const ExactVector& vector);

Integer dot(const ExactVector& a, const ExactVector& b);

/// Scales the vector by the power of two that brings its largest component to [1/2, 1), and rounds each
/// component by less than 2⁻⁵². Returns zero for the zero vector.
Eigen::Vector3d direction_of(const ExactVector& vector);

/// Computes numerator/denominator·2^exponent with an error below one unit in the last place (above the
/// subnormal numbers). The denominator must be positive.
double rounded_quotient(const Integer& numerator, const Integer& denominator, int exponent);

/// Computes √(square)/denominator·2^exponent with an error below two units in the last place (above the
/// subnormal numbers). The denominator must be positive.
double rounded_root_quotient(const Integer& square, const Integer& denominator, int exponent);

}  // namespace fringe::detail
