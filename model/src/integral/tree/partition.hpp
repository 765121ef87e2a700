#pragma once

#include <span>
#include <vector>

#include "fringe/triangle.hpp"
#include "integral/tree/node.hpp"

namespace fringe::detail {

/// About as many as keep the points of a node and those of its triangles in balance: with more, the leaves at
/// the plate's borders grow, with fewer the number of nodes does.
constexpr std::size_t most_triangles_in_leaf = 32;

struct Partition {
  std::vector<Node> nodes;
  std::vector<Triangle> triangles;
};

/// The triangles that have an area, halved again and again at the median of their centroids along the longest
/// side of the centroids' box, until a node has few enough to be a leaf. Only the nodes' ranges and children
/// are set.
Partition partition(std::span<const Triangle> triangles);

}  // namespace fringe::detail
