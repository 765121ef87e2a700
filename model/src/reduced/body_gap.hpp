#pragma once

#include "reduced/node_pair.hpp"

namespace fringe::detail {

/// A distance that two bodies have at least. Zero or less if they may touch, or one may be inside the other.
double body_gap(const PlacedBody& a, const PlacedBody& b);

}  // namespace fringe::detail
