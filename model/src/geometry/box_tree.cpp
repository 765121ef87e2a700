#include "geometry/box_tree.hpp"

#include <numeric>

namespace fringe::detail {
namespace {

using Eigen::AlignedBox3d;
using Eigen::Vector3d;

std::vector<Vector3d> centres_of(std::span<const AlignedBox3d> boxes) {
  std::vector<Vector3d> centres;
  centres.reserve(boxes.size());
  for (const AlignedBox3d& box : boxes)
    centres.emplace_back(box.center());
  return centres;
}

}  // namespace

BoxTree::BoxTree(std::span<const AlignedBox3d> boxes) : BoxTree(boxes, centres_of(boxes), 1) {}

BoxTree::BoxTree(std::span<const AlignedBox3d> boxes, std::span<const Vector3d> points, std::size_t leaf_size)
    : items_(boxes.size()), leaves_(boxes.size()) {
  if (boxes.empty())
    return;
  nodes_.reserve(2 * boxes.size() - 1);
  std::iota(items_.begin(), items_.end(), 0U);
  nodes_.push_back({AlignedBox3d(), 0, 0, 0, 0});
  split(0, 0, boxes.size(), {boxes, points, leaf_size});
}

void BoxTree::split(std::uint32_t node, std::size_t first, std::size_t count, const Source& source) {
  const std::span<std::uint32_t> items = std::span(items_).subspan(first, count);
  AlignedBox3d box;
  for (const std::uint32_t item : items)
    box.extend(source.boxes[item]);
  nodes_[node].box = box;
  if (count <= source.leaf_size) {
    nodes_[node].first = static_cast<std::uint32_t>(first);
    nodes_[node].count = static_cast<std::uint32_t>(count);
    for (const std::uint32_t item : items)
      leaves_[item] = node;
    return;
  }
  // Halves with equal numbers of items give the smallest height.
  const std::size_t half = count / 2;
  split_at_median(items, half, [&](std::uint32_t item) -> const Vector3d& { return source.points[item]; });
  const auto left = static_cast<std::uint32_t>(nodes_.size());
  nodes_[node].left = left;
  nodes_.push_back({AlignedBox3d(), node, 0, 0, 0});
  nodes_.push_back({AlignedBox3d(), node, 0, 0, 0});
  split(left, first, half, source);
  split(left + 1, first + half, count - half, source);
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
    const Vector3d sides = node.box.sizes();
    sum += sides.x() * sides.y() + sides.y() * sides.z() + sides.z() * sides.x();
  }
  return sum;
}

}  // namespace fringe::detail
