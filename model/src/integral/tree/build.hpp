#pragma once

#include <span>

#include "integral/tree/node.hpp"

namespace fringe::detail {

/// Builds the tree over the triangles of positive area; it has no nodes when there are none. The vertices
/// must be finite.
SurfaceNodes build_nodes(std::span<const Triangle> triangles);

}  // namespace fringe::detail
