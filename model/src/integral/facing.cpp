#include "integral/facing.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "numeric/dyadic.hpp"

namespace fringe::detail {
namespace {

using Eigen::Vector3d;

/// Evaluates the sign of side_of_plane without rounding.
int exact_side(const Vector3d& a, const Vector3d& b, const Vector3d& c, const Vector3d& p) {
  const Vector<Dyadic> origin = a.cast<Dyadic>();
  const Vector<Dyadic> u = b.cast<Dyadic>() - origin, v = c.cast<Dyadic>() - origin,
                       w = p.cast<Dyadic>() - origin;
  return u.cross(v).dot(w).sign();
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
