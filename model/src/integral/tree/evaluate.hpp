#pragma once

#include "fringe/surface_tree.hpp"
#include "integral/tree/node.hpp"

namespace fringe::detail {

/// Implements SurfaceTree::integrate for valid arguments.
TreeIntegral evaluate(const SurfaceNodes& tree, const Rectangle& plate, const TreeOptions& options);

}  // namespace fringe::detail
