#pragma once

#include "reduced/node_pair.hpp"

namespace fringe::detail {

/// Returns a lower bound of the distance between two bodies. It is zero or less if they may touch, or if one
/// may be inside the other.
double body_gap(const PlacedBody& a, const PlacedBody& b);

}  // namespace fringe::detail
