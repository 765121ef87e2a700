#pragma once

#include <array>
#include <vector>

#include <Eigen/Core>
#include <boost/multiprecision/cpp_int.hpp>

/// Vectors of rational numbers, with which certificates are checked.
namespace fringe::detail {

using Rational = boost::multiprecision::cpp_rational;
using RationalVector = std::array<Rational, 3>;

RationalVector rational(const Eigen::Vector3d& point);

Rational product(const RationalVector& a, const RationalVector& b);
RationalVector plus(const RationalVector& a, const RationalVector& b);
RationalVector minus(const RationalVector& a, const RationalVector& b);
RationalVector times(const Rational& factor, const RationalVector& vector);

/// A positive multiple of the point of the line or plane through two or three points that is nearest to the
/// origin; zero when they span none. One point is its own.
RationalVector towards_nearest(const std::vector<RationalVector>& points);

/// Whether some of the points, affinely independent ones, have the origin as a convex combination. By
/// Carathéodory's theorem that is so whenever the hull of all holds it.
bool hull_holds_origin(const std::vector<RationalVector>& points);

/// Of the hull of up to four points, the squared distance of a point that is no farther from the origin than
/// any other.
Rational squared_distance_to_origin(const std::vector<RationalVector>& points);

}  // namespace fringe::detail
