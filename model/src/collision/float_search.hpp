#pragma once

#include <optional>

#include "collision/hull_pair.hpp"

/// The search in floating point, which ends most queries and starts the exact one of the others
/// (model/NUMERICS.md, section 13).
namespace fringe::detail {

enum class Goal {
  decision,  ///< whether the hulls intersect
  distance   ///< the nearest points, too
};

struct FloatSearch {
  /// What is proven, with regard to every rounding. With the goal `distance`, never a separation.
  std::optional<GjkAnswer> answer;
  /// Otherwise, where the search got to: a simplex near the origin. Empty where it was not tried.
  PairSimplex reached;
};

FloatSearch float_search(const HullPair& hulls, Goal goal);

}  // namespace fringe::detail
