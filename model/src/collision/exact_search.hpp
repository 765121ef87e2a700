#pragma once

#include <array>

#include "exact_vector.hpp"
#include "float_search.hpp"
#include "hull_pair.hpp"

/// The search in integers, which decides whatever floating point cannot (model/NUMERICS.md, section 13).
namespace fringe::detail {

/// Two hulls in integers.
struct ExactHulls {
  const HullPair& hulls;
  int unit;  ///< coordinates count in units of 2^unit
};

ExactHulls exact_hulls(const HullPair& hulls);

/// A point of the Minkowski difference: Σ weightsᵢ (aᵢ − bᵢ)/total over the pairs of the simplex, all weights
/// positive.
struct ExactNearest {
  PairSimplex simplex;
  std::array<Integer, 4> weights;
  Integer total;
  ExactVector point;  ///< times `total`, in units
};

/// From any simplex, or an empty one: the point of the Minkowski difference nearest to the origin. With the
/// goal `decision` any point p will do for disjoint hulls that has p·q > 0 for all points q of the
/// difference.
ExactNearest exact_search(const ExactHulls& exact, const PairSimplex& start, Goal goal);

/// Whether direction·a < direction·b for all vertices.
bool separates(const ExactHulls& exact, const Eigen::Vector3d& direction);

}  // namespace fringe::detail
