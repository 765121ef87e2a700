#include "collision/box_tree.hpp"

#include <algorithm>
#include <numeric>

namespace fringe::detail {

using Eigen::AlignedBox3d;

BoxTree::BoxTree(std::span<const AlignedBox3d> boxes) : leaves_(boxes.size()) {
  if (boxes.empty())
    return;
  nodes_.reserve(2 * boxes.size() - 1);
  std::vector<std::uint32_t> items(boxes.size());
  std::iota(items.begin(), items.end(), 0U);
  nodes_.push_back({AlignedBox3d(), 0, 0, none});
  split(0, items, boxes);
}

void BoxTree::split(std::uint32_t node, std::span<std::uint32_t> items, std::span<const AlignedBox3d> boxes) {
  AlignedBox3d box, centres;
  for (const std::uint32_t item : items) {
    box.extend(boxes[item]);
    centres.extend(boxes[item].center());
  }
  nodes_[node].box = box;
  if (items.size() == 1) {
    nodes_[node].item = items.front();
    leaves_[items.front()] = node;
    return;
  }
  // Halves of equal number along the longest side keep the tree as low as it can be.
  Eigen::Index axis = 0;
  centres.sizes().maxCoeff(&axis);
  const std::size_t half = items.size() / 2;
  std::nth_element(
      items.begin(), items.begin() + static_cast<std::ptrdiff_t>(half), items.end(),
      [&](std::uint32_t a, std::uint32_t b) { return boxes[a].center()[axis] < boxes[b].center()[axis]; });
  const auto left = static_cast<std::uint32_t>(nodes_.size());
  nodes_[node].left = left;
  nodes_.push_back({AlignedBox3d(), node, 0, none});
  nodes_.push_back({AlignedBox3d(), node, 0, none});
  split(left, items.first(half), boxes);
  split(left + 1, items.subspan(half), boxes);
}

void BoxTree::move(std::size_t item, const AlignedBox3d& box) {
  std::uint32_t node = leaves_[item];
  nodes_[node].box = box;
  while (node != 0) {
    node = nodes_[node].parent;
    const AlignedBox3d joint = left(nodes_[node]).box.merged(right(nodes_[node]).box);
    if (joint.min() == nodes_[node].box.min() && joint.max() == nodes_[node].box.max())
      return;
    nodes_[node].box = joint;
  }
}

double BoxTree::cost() const {
  double sum = 0;
  for (const Node& node : nodes_) {
    const Eigen::Vector3d sides = node.box.sizes();
    sum += sides.x() * sides.y() + sides.y() * sides.z() + sides.z() * sides.x();
  }
  return sum;
}

}  // namespace fringe::detail
