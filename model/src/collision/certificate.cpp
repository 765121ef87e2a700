#include <algorithm>
#include <array>
#include <cstddef>
#include <optional>
#include <vector>

#include "collision/rational_vector.hpp"
#include "fringe/gjk.hpp"

/// Verifies certificates with nothing but the coordinates and rational arithmetic.
namespace fringe {
namespace {

using detail::Rational;
using detail::RationalVector;
using Vertices = std::span<const Eigen::Vector3d>;

/// Tests whether direction·a < direction·b for all vertices a and b.
bool separates(const RationalVector& direction, Vertices a, Vertices b) {
  std::optional<Rational> highest;
  for (const Eigen::Vector3d& vertex : a) {
    const Rational height = detail::product(direction, detail::rational(vertex));
    if (!highest || height > *highest)
      highest = height;
  }
  return highest && std::all_of(b.begin(), b.end(), [&](const Eigen::Vector3d& vertex) {
           return detail::product(direction, detail::rational(vertex)) > *highest;
         });
}

/// Returns the points a − b of the pairs; no points if an index is out of range.
std::vector<RationalVector> points_of(const PairSimplex& simplex, Vertices a, Vertices b) {
  std::vector<RationalVector> points;
  for (std::size_t i = 0; i < std::min(simplex.size, simplex.pairs.size()); ++i) {
    const auto& [index_a, index_b] = simplex.pairs[i];
    if (index_a >= a.size() || index_b >= b.size())
      return {};
    points.push_back(detail::minus(detail::rational(a[index_a]), detail::rational(b[index_b])));
  }
  return points;
}

}  // namespace

bool proves(const GjkAnswer& answer, Vertices a, Vertices b) {
  if (const auto* direction = std::get_if<SeparatingDirection>(&answer.certificate))
    return !answer.intersects && direction->direction.allFinite() &&
           separates(detail::rational(direction->direction), a, b);
  if (const auto* separating = std::get_if<SeparatingSimplex>(&answer.certificate)) {
    const std::vector<RationalVector> points = points_of(separating->simplex, a, b);
    return !answer.intersects && !points.empty() && points.size() <= 3 &&
           separates(detail::times(-1, detail::towards_nearest(points)), a, b);
  }
  return answer.intersects && detail::hull_holds_origin(
                                  points_of(std::get<SimplexAroundOrigin>(answer.certificate).simplex, a, b));
}

}  // namespace fringe
