#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <optional>
#include <type_traits>

#include "fringe/gjk.hpp"
#include "numeric/dyadic.hpp"

/// The iteration of Gilbert, Johnson and Keerthi for exact numbers and any kind of shape (model/NUMERICS.md,
/// section 13). The searches in floating point are others, compiled for every instruction set: the filter,
/// which keeps of each round the signs that decide, and the one for distances.
namespace fringe::detail {

/// A simplex of a Minkowski difference A − B, reduced to the face that contains its point nearest to the
/// origin.
template <class Number>
struct NearestFace {
  Simplex simplex;
  std::array<Vector<Number>, 4> points;  ///< the differences of its pairs
  std::array<Number, 4> weights;         ///< positive, for each point of the face
  Number total;                          ///< sum of the weights; 1 in floating point
  Vector<Number> nearest;                ///< Σ weightsᵢ pointsᵢ: the nearest point times `total`

  void add(const PointPair& pair, const Vector<Number>& point) {
    simplex.pairs[simplex.size] = pair;
    points[simplex.size++] = point;
  }

  bool contains(const PointPair& pair) const {
    return std::any_of(simplex.pairs.begin(),
                       simplex.pairs.begin() + static_cast<std::ptrdiff_t>(simplex.size),
                       [&](const PointPair& own) { return own.a == pair.a && own.b == pair.b; });
  }

  /// Reduces the simplex to the smallest face that contains the point nearest to the origin, by Johnson's
  /// determinants. In exact arithmetic there always is one, even if the points are affinely dependent; in
  /// floating point it may happen that no face passes the test. Then returns false and changes nothing.
  bool reduce();

 private:
  /// Keeps the points whose bits are set, with their weights, and computes the nearest point.
  void keep(unsigned members, const std::array<Number, 4>& determinants);
};

template <class Number>
bool NearestFace<Number>::reduce() {
  const std::size_t size = simplex.size;
  std::array<std::array<Number, 4>, 4> gram;
  // Computes pᵢ·(pⱼ − pₖ). In floating point, differences of squares would lose the digits in which points
  // that lie close together differ.
  const auto product = [&](std::size_t i, std::size_t j, std::size_t k) -> Number {
    if constexpr (std::is_floating_point_v<Number>)
      return points[i].dot(points[j] - points[k]);
    else
      return gram[i][j] - gram[i][k];
  };
  if constexpr (!std::is_floating_point_v<Number>)
    for (std::size_t i = 0; i < size; ++i)
      for (std::size_t j = 0; j <= i; ++j)
        gram[i][j] = gram[j][i] = points[i].dot(points[j]);
  const auto holds = [](unsigned subset, std::size_t point) { return ((subset >> point) & 1U) != 0; };
  // All subsets of four points as bit sets, in order of size.
  constexpr std::array<unsigned, 15> subsets{1, 2, 4, 8, 3, 5, 6, 9, 10, 12, 7, 11, 13, 14, 15};
  std::array<std::array<Number, 4>, 16> determinants;
  for (std::size_t i = 0; i < size; ++i)
    determinants[1U << i][i] = Number(1);
  for (const unsigned subset : subsets) {
    if (subset >= (1U << size))
      continue;
    bool is_nearest = true;
    std::size_t first = 0;
    while (!holds(subset, first))
      ++first;
    for (std::size_t i = first; i < size; ++i)
      is_nearest = is_nearest && (!holds(subset, i) || determinants[subset][i] > Number(0));
    for (std::size_t j = 0; j < size; ++j) {
      if (holds(subset, j))
        continue;
      Number next(0);
      for (std::size_t i = first; i < size; ++i)
        if (holds(subset, i))
          next += determinants[subset][i] * product(i, first, j);
      is_nearest = is_nearest && next <= Number(0);
      determinants[subset | (1U << j)][j] = next;
    }
    if (is_nearest) {
      keep(subset, determinants[subset]);
      return true;
    }
  }
  return false;
}

template <class Number>
void NearestFace<Number>::keep(unsigned members, const std::array<Number, 4>& determinants) {
  std::size_t kept = 0;
  total = Number(0);
  for (std::size_t i = 0; i < simplex.size; ++i)
    if (((members >> i) & 1U) != 0) {
      simplex.pairs[kept] = simplex.pairs[i];
      points[kept] = points[i];
      weights[kept++] = determinants[i];
      total += determinants[i];
    }
  simplex.size = kept;
  if constexpr (std::is_floating_point_v<Number>) {
    for (std::size_t i = 0; i < kept; ++i)
      weights[i] /= total;
    total = 1;
  }
  nearest = Vector<Number>::Zero();
  for (std::size_t i = 0; i < kept; ++i)
    nearest += weights[i] * points[i];
}

/// Runs the iteration from a simplex: reduces it to the face nearest to the origin, and adds the pair of
/// support points towards the origin, until the difference asks for no other or rounding hides the face.
///
/// A difference has two functions. point(pair) computes the difference of a pair's moved points in Numbers.
/// next_pair(face) returns a pair whose difference lies farther towards the origin than the face's nearest
/// point, or nothing if the face answers the query or no such pair is found.
template <class Number, class Difference>
NearestFace<Number> gjk(Difference& difference, const Simplex& start) {
  NearestFace<Number> face;
  for (std::size_t i = 0; i < start.size; ++i)
    face.add(start.pairs[i], difference.point(start.pairs[i]));
  face.reduce();
  while (const std::optional<PointPair> pair = difference.next_pair(face)) {
    face.add(*pair, difference.point(*pair));
    if (!face.reduce()) {
      --face.simplex.size;
      break;
    }
  }
  return face;
}

}  // namespace fringe::detail
