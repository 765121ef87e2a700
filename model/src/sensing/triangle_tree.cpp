#include "sensing/triangle_tree.hpp"

#include <cstdint>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "fringe/error.hpp"
#include "fringe/pose.hpp"
#include "sensing/cone_bounds.hpp"

namespace fringe::detail {
namespace {

using Eigen::Vector3d;

/// Triangles in a leaf: testing a triangle takes as long as a dozen boxes, but leaves of single triangles
/// need twice the memory.
constexpr std::size_t triangles_per_leaf = 2;

Eigen::AlignedBox3d box_of(const Triangle& triangle) {
  Eigen::AlignedBox3d box(triangle[0]);
  return box.extend(triangle[1]).extend(triangle[2]);
}

}  // namespace

TriangleTree::TriangleTree(std::span<const Triangle> triangles) {
  if (triangles.size() > std::numeric_limits<std::uint32_t>::max() / 2)
    throw InputError("a surface may have at most 2^31 triangles");
  std::vector<Eigen::AlignedBox3d> boxes;
  std::vector<Vector3d> centres;
  boxes.reserve(triangles.size());
  centres.reserve(triangles.size());
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    for (const Vector3d& vertex : triangles[i])
      if (!vertex.allFinite())
        throw InputError(fmt::format("triangle {} is not finite", i));
    boxes.push_back(box_of(triangles[i]));
    centres.emplace_back(triangles[i][0] / 3 + triangles[i][1] / 3 + triangles[i][2] / 3);
  }
  tree_ = BoxTree(boxes, centres, triangles_per_leaf);
  triangles_.reserve(triangles.size());
  for (const std::uint32_t item : tree_.items())
    triangles_.push_back(triangles[item]);
}

void TriangleTree::search(ConeQuery& query, const Eigen::Isometry3d& pose, std::size_t surface) const {
  if (tree_.empty())
    return;
  const Eigen::AlignedBox3d& whole = tree_.root().box;
  const Vector3d farthest = whole.min().cwiseAbs().cwiseMax(whole.max().cwiseAbs());
  if (!(pose.linear().cwiseAbs() * farthest + pose.translation().cwiseAbs()).allFinite())
    throw InputError("a surface reaches too far");
  struct Visit {
    double least_distance;
    const BoxTree::Node* node;
  };
  const ConeBounds bounds(query.cone(), pose);
  // For a whole object the most precise test pays off.
  if (bounds.least_distance(whole) > query.reach() || bounds.misses(whole) ||
      ConeShape(query.cone(), query.reach()).misses(whole, pose))
    return;
  const auto visit = [&](const BoxTree::Node& node) { return Visit{bounds.least_distance(node.box), &node}; };
  std::vector<Visit> waiting{visit(tree_.root())};
  while (!waiting.empty()) {
    const auto [least_distance, place] = waiting.back();
    waiting.pop_back();
    const BoxTree::Node& node = *place;
    if (least_distance > query.reach() || bounds.misses(node.box))
      continue;
    if (!node.is_leaf()) {
      Visit near = visit(tree_.left(node)), far = visit(tree_.right(node));
      if (far.least_distance < near.least_distance)
        std::swap(near, far);
      waiting.push_back(far);
      waiting.push_back(near);
      continue;
    }
    for (std::size_t i = node.first; i < node.first + node.count; ++i)
      if (!bounds.misses(triangles_[i], query.reach()))
        query.offer(transformed(triangles_[i], pose), surface, tree_.items()[i]);
  }
}

}  // namespace fringe::detail
