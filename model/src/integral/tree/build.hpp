#pragma once

#include <span>
#include <vector>

#include "fringe/triangle.hpp"
#include "integral/tree/node.hpp"

namespace fringe::detail {

/// Largest number of triangles in a leaf. It balances the points of nodes against those of triangles: with
/// more, the leaves at the plate's borders grow; with fewer, the number of nodes does.
constexpr std::size_t most_triangles_in_leaf = 32;

struct Partition {
  std::vector<Node> nodes;
  std::vector<Triangle> triangles;
};

/// Bisects the triangles of positive area at the median of their centroids, along the longest side of the
/// centroids' box, until every leaf has at most most_triangles_in_leaf. Sets only the nodes' ranges and
/// children.
Partition partition(std::span<const Triangle> triangles);

/// Builds the tree over the triangles of positive area; it has no nodes when there are none. The vertices
/// must be finite.
SurfaceNodes build_nodes(std::span<const Triangle> triangles);

}  // namespace fringe::detail
