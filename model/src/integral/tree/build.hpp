#pragma once

#include <span>

#include "integral/tree/node.hpp"

namespace fringe::detail {

/// The tree over the triangles that have an area; no nodes when none has. The vertices must be finite.
SurfaceNodes build_nodes(std::span<const Triangle> triangles);

}  // namespace fringe::detail
