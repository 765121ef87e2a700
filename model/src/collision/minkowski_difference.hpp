#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>
#include <optional>
#include <type_traits>

#include <Eigen/Core>

#include "collision/convex_pair.hpp"
#include "fringe/gjk.hpp"
#include "numeric/dyadic.hpp"

/// The searches of gjk() that floating point leaves: the iteration of Gilbert, Johnson and Keerthi for exact
/// numbers and any kind of shape (model/NUMERICS.md, section 13), over the Minkowski difference A − B of two
/// convex shapes, which is exact for polytopes, and exact in points of round shapes. The searches in floating
/// point are others, compiled for every instruction set: the filter, which keeps of each round the signs that
/// decide, and the one for distances.
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

/// Exact positions of a shape's points.
struct ExactPlacement {
  bool in_place;  ///< whether the pose is the identity
  Eigen::Matrix<Dyadic, 3, 3> rotation;
  Vector<Dyadic> translation;

  explicit ExactPlacement(const Eigen::Isometry3d& pose);
  Vector<Dyadic> position(const Eigen::Vector3d& point) const;

  /// Turns a direction into the shape's own frame: its products with points change by a constant only.
  Vector<Dyadic> turned_back(const Vector<Dyadic>& direction) const;
};

/// A difference with exact positions, of the given numbers of vertices and poses.
class ExactDifference {
 public:
  explicit ExactDifference(const ConvexPair& pair);

  Vector<Dyadic> point(const PointPair& pair) const { return a_.position(pair.a) - b_.position(pair.b); }

  /// Computes the distance of a face's nearest point from the origin and the witness points. The distance is
  /// accurate to three units in the last place, each coordinate to one.
  GjkDistance distance(const NearestFace<Dyadic>& face) const;

 protected:
  const ConvexPair& pair_;
  ExactPlacement a_, b_;
};

/// What a search of two polytopes is for.
enum class Goal {
  decision,  ///< decide whether they intersect: any point p suffices for which p·q > 0 for all differences q
  distance   ///< find the nearest points, too
};

/// The difference of two polytopes, whose vertices are compared exactly. Every nearest point is that of one
/// of finitely many simplices and none occurs twice, so the search ends.
class PolytopeDifference : public ExactDifference {
 public:
  PolytopeDifference(const ConvexPair& pair, Goal goal) : ExactDifference(pair), goal_(goal) {}

  std::optional<PointPair> next_pair(const NearestFace<Dyadic>& face) const;

  /// Tests whether direction·a < direction·b for all vertices a and b.
  bool separates(const Eigen::Vector3d& direction) const;

 private:
  /// Finds the vertices whose difference is farthest along a direction.
  PointPair farthest_along(const Vector<Dyadic>& direction) const;

  Goal goal_;
};

/// The difference of two shapes with round surfaces. Their support points are rounded, and moved inwards so
/// that they certainly belong to the shapes; from there on the search is exact. It ends with an answer, or
/// when another pair would gain no more than rounding.
class RoundDifference : public ExactDifference {
 public:
  explicit RoundDifference(const ConvexPair& pair) : ExactDifference(pair) {}

  std::optional<PointPair> next_pair(const NearestFace<Dyadic>& face);

  /// Moves the points of round shapes inwards.
  PointPair inside(const PointPair& pair) const;

  /// Returns what the search has shown: a common point, a separating direction, or that rounding hides it.
  GjkAnswer answer() const { return answer_; }

 private:
  GjkAnswer answer_{};
  HiddenByRounding hidden_{Eigen::Vector3d::Zero(), std::numeric_limits<double>::infinity(), {}, 0};
  int round_ = 0;
};

}  // namespace fringe::detail
