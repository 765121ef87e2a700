#include "collision/float_search.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "collision/nearest_face.hpp"

namespace fringe::detail {
namespace {

using Eigen::Vector3d;

/// A simplex of vertex pairs with their rounded differences.
struct FloatSimplex {
  PairSimplex simplex;
  std::array<Vector3d, 4> points;

  void add(const HullPair& hulls, VertexPair pair) {
    simplex.pairs[simplex.size] = pair;
    points[simplex.size] = hulls.a[pair.a] - hulls.b[pair.b];
    ++simplex.size;
  }

  bool holds(VertexPair pair) const {
    return std::any_of(simplex.pairs.begin(),
                       simplex.pairs.begin() + static_cast<std::ptrdiff_t>(simplex.size),
                       [=](VertexPair own) { return own.a == pair.a && own.b == pair.b; });
  }

  /// Reduces the simplex to the members of a face.
  void keep(unsigned members) {
    std::size_t kept = 0;
    for (std::size_t i = 0; i < simplex.size; ++i)
      if (detail::holds(members, i)) {
        simplex.pairs[kept] = simplex.pairs[i];
        points[kept++] = points[i];
      }
    simplex.size = kept;
  }
};

/// Returns the sign of the determinant of three points, each coordinate of which is a rounded difference; 0
/// if rounding may have changed it. Seven roundings stand between the coordinates and each of the six
/// products (J. R. Shewchuk, Discrete & Computational Geometry 18, 1997, 305). In the safe range no product
/// underflows that matters.
int certain_sign(const Vector3d& p, const Vector3d& q, const Vector3d& r) {
  constexpr double unit_roundoff = std::numeric_limits<double>::epsilon() / 2;
  constexpr double error_per_magnitude = (7 + 56 * unit_roundoff) * unit_roundoff;
  constexpr double smallest_magnitude = 1e-200;
  const Vector3d positive(p.y() * q.z(), p.z() * q.x(), p.x() * q.y());
  const Vector3d negative(p.z() * q.y(), p.x() * q.z(), p.y() * q.x());
  const double determinant = (positive - negative).dot(r);
  const double magnitude = (positive.cwiseAbs() + negative.cwiseAbs()).dot(r.cwiseAbs());
  if (magnitude < smallest_magnitude || std::abs(determinant) <= error_per_magnitude * magnitude)
    return 0;
  return determinant > 0 ? 1 : -1;
}

/// Tests whether the origin certainly lies inside the tetrahedron: its barycentric coordinates are
/// proportional to these determinants with alternating signs.
bool surely_around_origin(const std::array<Vector3d, 4>& points) {
  const auto& [p, q, r, s] = points;
  const int sign = certain_sign(q, r, s);
  return sign != 0 && certain_sign(p, r, s) == -sign && certain_sign(p, q, s) == sign &&
         certain_sign(p, q, r) == -sign;
}

/// Returns the point of the face nearest to the origin, by its barycentric coordinates.
Vector3d nearest_point(const FloatSimplex& simplex, const NearestFace<double>& face) {
  Vector3d sum = Vector3d::Zero();
  double total = 0;
  for (std::size_t i = 0; i < simplex.simplex.size; ++i)
    if (holds(face.members, i)) {
      sum += face.weights[i] * simplex.points[i];
      total += face.weights[i];
    }
  return sum / total;
}

}  // namespace

FloatSearch float_search(const HullPair& hulls, Goal goal) {
  // Limit of iterations; more than ten are rarely needed. The exact search continues from where this one
  // ends.
  constexpr int most_rounds = 40;
  // The iteration stops at this duality gap relative to the squared distance, where rounding errors outweigh
  // any further gain.
  constexpr double no_gain = 1e-14;
  if (!in_safe_range(hulls))
    return {};
  FloatSimplex simplex;
  simplex.add(hulls, {0, 0});
  Vector3d nearest = simplex.points[0];
  for (int round = 0; round < most_rounds; ++round) {
    const Vector3d direction = -nearest;
    const double error = product_error(hulls, direction);
    // For a smaller error bound, products could lose digits to underflow, which the bound does not cover.
    constexpr double smallest_error = 1e-250;
    if (error < smallest_error)
      break;
    const Extreme a = farthest_along(hulls.a, hulls.origin, direction);
    const Extreme b = farthest_along(hulls.b, hulls.origin, -direction);
    if (goal == Goal::decision && a.product + b.product < -error)
      return {GjkAnswer{false, SeparatingDirection{direction}}, simplex.simplex};
    const VertexPair pair{a.index, b.index};
    const double square = nearest.squaredNorm();
    if (simplex.holds(pair) || square + a.product + b.product <= no_gain * square)
      break;
    simplex.add(hulls, pair);
    const auto product = [&](std::size_t i, std::size_t j, std::size_t k) {
      return simplex.points[i].dot(simplex.points[j] - simplex.points[k]);
    };
    const auto face = nearest_face<double>(product, simplex.simplex.size);
    if (!face)
      break;
    nearest = nearest_point(simplex, *face);
    simplex.keep(face->members);
    if (simplex.simplex.size == 4) {
      if (surely_around_origin(simplex.points))
        return {GjkAnswer{true, SimplexAroundOrigin{simplex.simplex}}, simplex.simplex};
      break;
    }
  }
  return {std::nullopt, simplex.simplex};
}

}  // namespace fringe::detail
