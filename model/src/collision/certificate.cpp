#include <algorithm>
#include <array>
#include <cstddef>
#include <optional>
#include <vector>

#include <boost/multiprecision/cpp_int.hpp>

#include "fringe/gjk.hpp"

/// Certificates are checked with nothing but the coordinates and rational arithmetic.
namespace fringe {
namespace {

using Rational = boost::multiprecision::cpp_rational;
using RationalVector = std::array<Rational, 3>;
using Vertices = std::span<const Eigen::Vector3d>;

RationalVector rational(const Eigen::Vector3d& point) {
  return {Rational(point.x()), Rational(point.y()), Rational(point.z())};
}

Rational product(const RationalVector& a, const RationalVector& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

RationalVector minus(const RationalVector& a, const RationalVector& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}

RationalVector times(const Rational& factor, const RationalVector& vector) {
  return {factor * vector[0], factor * vector[1], factor * vector[2]};
}

RationalVector cross_product(const RationalVector& a, const RationalVector& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

bool separates(const RationalVector& direction, Vertices a, Vertices b) {
  std::optional<Rational> highest;
  for (const Eigen::Vector3d& vertex : a) {
    const Rational height = product(direction, rational(vertex));
    if (!highest || height > *highest)
      highest = height;
  }
  return highest && std::all_of(b.begin(), b.end(), [&](const Eigen::Vector3d& vertex) {
           return product(direction, rational(vertex)) > *highest;
         });
}

/// The points a − b of the pairs; none when an index is out of range.
std::vector<RationalVector> points_of(const PairSimplex& simplex, Vertices a, Vertices b) {
  std::vector<RationalVector> points;
  for (std::size_t i = 0; i < std::min(simplex.size, simplex.pairs.size()); ++i) {
    const auto& [index_a, index_b] = simplex.pairs[i];
    if (index_a >= a.size() || index_b >= b.size())
      return {};
    points.push_back(minus(rational(a[index_a]), rational(b[index_b])));
  }
  return points;
}

/// A positive multiple of the point of the line or plane through two or three points that is nearest to the
/// origin; zero when they span none.
RationalVector towards_nearest(const std::vector<RationalVector>& points) {
  const RationalVector& p = points[0];
  if (points.size() == 1)
    return p;
  const RationalVector along = minus(points[1], p);
  if (points.size() == 2)
    return minus(times(product(along, along), p), times(product(p, along), along));
  const RationalVector normal = cross_product(along, minus(points[2], p));
  return times(product(p, normal), normal);
}

using Rows = std::array<std::array<Rational, 5>, 4>;

/// Whether the equations (the last column is their right-hand side) have exactly one solution, and it is not
/// negative. Gauss-Jordan elimination.
bool solved_by_non_negative(Rows rows, std::size_t unknowns) {
  for (std::size_t column = 0; column < unknowns; ++column) {
    std::size_t pivot = column;
    while (pivot < rows.size() && rows[pivot][column].is_zero())
      ++pivot;
    if (pivot == rows.size())
      return false;
    std::swap(rows[pivot], rows[column]);
    for (std::size_t row = 0; row < rows.size(); ++row) {
      if (row == column)
        continue;
      const Rational factor = rows[row][column] / rows[column][column];
      for (std::size_t k = 0; k < rows[row].size(); ++k)
        rows[row][k] -= factor * rows[column][k];
    }
  }
  for (std::size_t row = 0; row < rows.size(); ++row) {
    const Rational& right = rows[row].back();
    if (row < unknowns ? right / rows[row][row] < 0 : !right.is_zero())
      return false;
  }
  return true;
}

/// Whether some of the points, affinely independent ones, have the origin as a convex combination. By
/// Carathéodory's theorem that is so whenever the hull of all holds it.
bool hull_holds_origin(const std::vector<RationalVector>& points) {
  for (unsigned subset = 1; subset < (1U << points.size()); ++subset) {
    Rows rows;
    std::size_t unknowns = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
      if (((subset >> i) & 1U) == 0)
        continue;
      for (std::size_t k = 0; k < 3; ++k)
        rows[k][unknowns] = points[i][k];
      rows[3][unknowns++] = 1;
    }
    rows[3].back() = 1;
    if (solved_by_non_negative(rows, unknowns))
      return true;
  }
  return false;
}

}  // namespace

bool proves(const GjkAnswer& answer, Vertices a, Vertices b) {
  if (const auto* direction = std::get_if<SeparatingDirection>(&answer.certificate))
    return !answer.intersects && direction->direction.allFinite() &&
           separates(rational(direction->direction), a, b);
  if (const auto* separating = std::get_if<SeparatingSimplex>(&answer.certificate)) {
    const std::vector<RationalVector> points = points_of(separating->simplex, a, b);
    return !answer.intersects && !points.empty() && points.size() <= 3 &&
           separates(minus({}, towards_nearest(points)), a, b);
  }
  return answer.intersects &&
         hull_holds_origin(points_of(std::get<SimplexAroundOrigin>(answer.certificate).simplex, a, b));
}

}  // namespace fringe
