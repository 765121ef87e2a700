#pragma once

#include <optional>

#include "collision/hull_pair.hpp"

/// GJK in floating point, which answers most queries and provides the exact search with a start for the
/// others (model/NUMERICS.md, section 13).
namespace fringe::detail {

enum class Goal {
  decision,  ///< decide whether the hulls intersect
  distance   ///< find the nearest points, too
};

struct FloatSearch {
  /// The answer, if it is proven for every possible rounding. With the goal `distance`, never a separation.
  std::optional<GjkAnswer> answer;
  /// The simplex near the origin that the search reached. Empty if the search was not tried.
  PairSimplex reached;
};

/// Runs GJK in floating point.
FloatSearch float_search(const HullPair& hulls, Goal goal);

}  // namespace fringe::detail
