#include "integral/facing.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>

#include <boost/multiprecision/cpp_int.hpp>

namespace fringe::detail {
namespace {

using boost::multiprecision::cpp_int;
using Eigen::Vector3d;
using ExactVector = std::array<cpp_int, 3>;

/// A double as integer·2^exponent.
struct ScaledInteger {
  std::int64_t integer;
  int exponent;
};

ScaledInteger scaled_integer(double number) {
  constexpr int digits = std::numeric_limits<double>::digits;
  int exponent = 0;
  const double mantissa = std::frexp(number, &exponent);
  return {static_cast<std::int64_t>(std::ldexp(mantissa, digits)), exponent - digits};
}

/// Returns the smallest exponent of the nonzero coordinates: in units of 2^exponent all coordinates are
/// integers.
int common_unit(const std::array<const Vector3d*, 4>& points) {
  int unit = std::numeric_limits<int>::max();
  for (const Vector3d* point : points)
    for (const double coordinate : *point)
      if (coordinate != 0)
        unit = std::min(unit, scaled_integer(coordinate).exponent);
  return unit;
}

ExactVector exact_difference(const Vector3d& to, const Vector3d& from, int unit) {
  const auto in_units = [=](double coordinate) {
    const auto [integer, exponent] = scaled_integer(coordinate);
    return integer == 0 ? cpp_int(0) : cpp_int(integer) << static_cast<unsigned>(exponent - unit);
  };
  ExactVector difference;
  for (int i = 0; i < 3; ++i)
    difference[static_cast<std::size_t>(i)] = in_units(to[i]) - in_units(from[i]);
  return difference;
}

/// Evaluates the sign of side_of_plane in integer arithmetic.
int exact_side(const Vector3d& a, const Vector3d& b, const Vector3d& c, const Vector3d& p) {
  const int unit = common_unit({&a, &b, &c, &p});
  const ExactVector u = exact_difference(b, a, unit), v = exact_difference(c, a, unit),
                    w = exact_difference(p, a, unit);
  const cpp_int determinant = (u[1] * v[2] - u[2] * v[1]) * w[0] + (u[2] * v[0] - u[0] * v[2]) * w[1] +
                              (u[0] * v[1] - u[1] * v[0]) * w[2];
  return determinant.sign();
}

}  // namespace

int side_of_plane(const Vector3d& a, const Vector3d& b, const Vector3d& c, const Vector3d& p) {
  // Static filter: each of the six products of the determinant carries seven rounding errors, including those
  // of the differences (J. R. Shewchuk, Discrete & Computational Geometry 18, 1997, 305).
  constexpr double unit_roundoff = std::numeric_limits<double>::epsilon() / 2;
  constexpr double error_per_magnitude = (7 + 56 * unit_roundoff) * unit_roundoff;
  // Below this magnitude a product may have lost digits to underflow, which the error analysis of the filter
  // does not cover.
  constexpr double smallest_magnitude = 1e-200;
  const Vector3d u = b - a, v = c - a, w = p - a;
  const Vector3d positive(u.y() * v.z(), u.z() * v.x(), u.x() * v.y());
  const Vector3d negative(u.z() * v.y(), u.x() * v.z(), u.y() * v.x());
  const double determinant = (positive - negative).dot(w);
  const double magnitude = (positive.cwiseAbs() + negative.cwiseAbs()).dot(w.cwiseAbs());
  // Overflow makes this condition false, so that the exact arithmetic decides.
  if (magnitude > smallest_magnitude && std::isfinite(magnitude) &&
      std::abs(determinant) > error_per_magnitude * magnitude)
    return determinant > 0 ? 1 : -1;
  return exact_side(a, b, c, p);
}

Sight sight(const Triangle& triangle, const Rectangle& plate) {
  const auto& [a, b, c] = triangle;
  const auto& [corner, edge_u, edge_v] = plate;
  int farthest = -1;
  for (const Vector3d& point :
       {corner, Vector3d(corner + edge_u), Vector3d(corner + edge_v), Vector3d(corner + edge_u + edge_v)}) {
    farthest = std::max(farthest, side_of_plane(a, b, c, point));
    if (farthest > 0)
      return Sight::outward;
  }
  return farthest == 0 ? Sight::grazing : Sight::none;
}

}  // namespace fringe::detail
