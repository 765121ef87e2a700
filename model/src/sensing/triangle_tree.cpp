#include "sensing/triangle_tree.hpp"

#include <algorithm>
#include <limits>
#include <numeric>
#include <utility>

#include <fmt/format.h>

#include "fringe/error.hpp"
#include "fringe/pose.hpp"
#include "sensing/cone_bounds.hpp"
#include "sensing/cone_shape.hpp"

namespace fringe::detail {
namespace {

using Eigen::Vector3d;

/// A triangle costs as much as a dozen boxes, boxes of single triangles twice the memory.
constexpr std::size_t triangles_per_leaf = 2;

Eigen::AlignedBox3d box_of(const Triangle& triangle) {
  Eigen::AlignedBox3d box(triangle[0]);
  return box.extend(triangle[1]).extend(triangle[2]);
}

}  // namespace

TriangleTree::TriangleTree(std::span<const Triangle> triangles) : indices_(triangles.size()) {
  if (triangles.size() > std::numeric_limits<std::uint32_t>::max() / 2)
    throw InputError("a surface may have at most 2^31 triangles");
  std::vector<Vector3d> centres;
  centres.reserve(triangles.size());
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    for (const Vector3d& vertex : triangles[i])
      if (!vertex.allFinite())
        throw InputError(fmt::format("triangle {} is not finite", i));
    centres.emplace_back(triangles[i][0] / 3 + triangles[i][1] / 3 + triangles[i][2] / 3);
  }
  std::iota(indices_.begin(), indices_.end(), 0U);
  nodes_.reserve(triangles.size());
  if (triangles.empty())
    return;
  triangles_.assign(triangles.begin(), triangles.end());
  build(0, triangles.size(), centres);
  for (std::size_t i = 0; i < triangles.size(); ++i)
    triangles_[i] = triangles[indices_[i]];
}

/// Adds the node of some of the triangles, halved at the median along the longest side of their centres' box.
void TriangleTree::build(std::size_t first, std::size_t last, std::span<const Vector3d> centres) {
  const std::size_t node = nodes_.size();
  nodes_.emplace_back();
  Eigen::AlignedBox3d box, spread;
  for (std::size_t i = first; i < last; ++i) {
    box.extend(box_of(triangles_[indices_[i]]));
    spread.extend(centres[indices_[i]]);
  }
  nodes_[node].box = box;
  if (last - first <= triangles_per_leaf) {
    nodes_[node].first_triangle = static_cast<std::uint32_t>(first);
    nodes_[node].triangle_count = static_cast<std::uint32_t>(last - first);
    return;
  }
  Eigen::Index axis = 0;
  (spread.max() / 2 - spread.min() / 2).maxCoeff(&axis);
  const std::size_t middle = first + (last - first) / 2;
  const auto at = [&](std::size_t i) { return indices_.begin() + static_cast<std::ptrdiff_t>(i); };
  // Equal coordinates are told apart by the index, so that the tree is the same with every standard library.
  std::nth_element(at(first), at(middle), at(last), [&](std::uint32_t a, std::uint32_t b) {
    return std::pair(centres[a][axis], a) < std::pair(centres[b][axis], b);
  });
  build(first, middle, centres);
  nodes_[node].second_child = static_cast<std::uint32_t>(nodes_.size());
  build(middle, last, centres);
}

void TriangleTree::search(ConeQuery& query, const Eigen::Isometry3d& pose, std::size_t surface) const {
  if (nodes_.empty())
    return;
  const Vector3d farthest = nodes_[0].box.min().cwiseAbs().cwiseMax(nodes_[0].box.max().cwiseAbs());
  if (!(pose.linear().cwiseAbs() * farthest + pose.translation().cwiseAbs()).allFinite())
    throw InputError("a surface reaches too far");
  struct Visit {
    double least_distance;
    std::uint32_t node;
  };
  const ConeBounds bounds(query.cone(), pose);
  // Whole objects are worth the sharpest test.
  if (bounds.least_distance(nodes_[0].box) > query.reach() || bounds.misses(nodes_[0].box) ||
      ConeShape(query.cone(), query.reach()).misses(nodes_[0].box, pose))
    return;
  const auto visit = [&](std::uint32_t node) { return Visit{bounds.least_distance(nodes_[node].box), node}; };
  std::vector<Visit> waiting{visit(0)};
  while (!waiting.empty()) {
    const auto [least_distance, index] = waiting.back();
    waiting.pop_back();
    const Node& node = nodes_[index];
    if (least_distance > query.reach() || bounds.misses(node.box))
      continue;
    if (node.triangle_count == 0) {
      Visit near = visit(index + 1), far = visit(node.second_child);
      if (far.least_distance < near.least_distance)
        std::swap(near, far);
      waiting.push_back(far);
      waiting.push_back(near);
      continue;
    }
    for (std::size_t i = node.first_triangle; i < node.first_triangle + node.triangle_count; ++i)
      if (!bounds.misses(triangles_[i], query.reach()))
        query.offer(transformed(triangles_[i], pose), surface, indices_[i]);
  }
}

}  // namespace fringe::detail
