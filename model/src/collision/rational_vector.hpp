#pragma once

#include <array>
#include <vector>

#include <Eigen/Core>
#include <boost/multiprecision/cpp_int.hpp>

/// Vectors of rational numbers, with which certificates are verified.
namespace fringe::detail {

using Rational = boost::multiprecision::cpp_rational;
using RationalVector = std::array<Rational, 3>;

RationalVector rational(const Eigen::Vector3d& point);

Rational product(const RationalVector& a, const RationalVector& b);
RationalVector plus(const RationalVector& a, const RationalVector& b);
RationalVector minus(const RationalVector& a, const RationalVector& b);
RationalVector times(const Rational& factor, const RationalVector& vector);

/// Returns a positive multiple of the point nearest to the origin on the line or plane through two or three
/// points; zero if the points are affinely dependent. A single point is returned as it is.
RationalVector towards_nearest(const std::vector<RationalVector>& points);

/// Tests whether the origin lies in the hull of the points: whether it is a convex combination of an affinely
/// independent subset, which by Carathéodory's theorem is equivalent.
bool hull_holds_origin(const std::vector<RationalVector>& points);

/// Computes the squared distance from the origin to the hull of up to four points.
Rational squared_distance_to_origin(const std::vector<RationalVector>& points);

}  // namespace fringe::detail
