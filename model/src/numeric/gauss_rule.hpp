#pragma once

#include <vector>

#include "numeric/gauss_node.hpp"

namespace fringe::detail {

using GaussRule = std::vector<GaussNode>;

/// Returns the Gauss–Legendre rule on [0, 1].
GaussRule gauss_rule(int points);

}  // namespace fringe::detail
