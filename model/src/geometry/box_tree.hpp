#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Geometry>

namespace fringe::detail {

/// Reorders items so that the first `half` of them lie below the others along the longest side of the box
/// around their points. Items with equal coordinates are ordered by their numbers, so that the result does
/// not depend on the standard library.
///
/// @param point_of returns the point of an item
/// @param number_of returns the number of an item, which differs between items
template <class Item, class PointOf, class NumberOf>
void split_at_median(std::span<Item> items, std::size_t half, const PointOf& point_of,
                     const NumberOf& number_of) {
  Eigen::AlignedBox3d box;
  for (const Item& item : items)
    box.extend(point_of(item));
  Eigen::Index axis = 0;
  // Half of each side, which cannot overflow.
  (box.max() / 2 - box.min() / 2).maxCoeff(&axis);
  std::nth_element(items.begin(), items.begin() + static_cast<std::ptrdiff_t>(half), items.end(),
                   [&](const Item& a, const Item& b) {
                     const double at_a = point_of(a)[axis], at_b = point_of(b)[axis];
                     return at_a < at_b || (at_a == at_b && number_of(a) < number_of(b));
                   });
}

/// Does the same for items that are numbers themselves.
template <class Number, class PointOf>
void split_at_median(std::span<Number> numbers, std::size_t half, const PointOf& point_of) {
  split_at_median(numbers, half, point_of, [](Number number) { return number; });
}

/// A bounding volume hierarchy: a binary tree of axis-aligned boxes over numbered items (thesis 3.3, last
/// paragraph). A node's box contains the boxes of all items below it.
class BoxTree {
 public:
  struct Node {
    Eigen::AlignedBox3d box;
    std::uint32_t parent;  ///< index; the root's is its own
    std::uint32_t left;    ///< index, 0 for a leaf; the right child follows the left one
    std::uint32_t first;   ///< leaves only: position of the first item in items()
    std::uint32_t count;   ///< leaves only: number of items

    bool is_leaf() const { return left == 0; }
  };

  BoxTree() = default;

  /// Builds a tree with one leaf per box. An item's number is the index of its box.
  explicit BoxTree(std::span<const Eigen::AlignedBox3d> boxes);

  /// Builds a tree by bisecting the items at the median of their points until no leaf has more than
  /// `leaf_size`.
  BoxTree(std::span<const Eigen::AlignedBox3d> boxes, std::span<const Eigen::Vector3d> points,
          std::size_t leaf_size);

  bool empty() const { return nodes_.empty(); }
  /// Returns all nodes, the root first; children come after their parents.
  std::span<const Node> nodes() const { return nodes_; }
  const Node& root() const { return nodes_.front(); }
  const Node& left(const Node& node) const { return nodes_[node.left]; }
  const Node& right(const Node& node) const { return nodes_[node.left + 1]; }

  /// Returns the numbers of all items, ordered so that those of a leaf are consecutive.
  std::span<const std::uint32_t> items() const { return items_; }
  /// Returns the item of a leaf that has only one.
  std::uint32_t item(const Node& leaf) const { return items_[leaf.first]; }
  /// Returns the leaf that contains an item.
  const Node& leaf_of(std::size_t item) const { return nodes_[leaves_[item]]; }

  /// Calls `action` with the number of every item whose leaf meets a box.
  template <class Action>
  void for_each(const Eigen::AlignedBox3d& box, const Action& action) const {
    if (!empty())
      for_each_below(root(), box, action);
  }

  /// Replaces the box of an item that is alone in its leaf, and refits the boxes above it. The tree's
  /// topology stays.
  void move(std::size_t item, const Eigen::AlignedBox3d& box);

  /// Computes the sum of the boxes' half surface areas, to which the cost of a search is roughly
  /// proportional.
  double cost() const;

 private:
  struct Source {
    std::span<const Eigen::AlignedBox3d> boxes;
    std::span<const Eigen::Vector3d> points;
    std::size_t leaf_size;
  };

  template <class Action>
  void for_each_below(const Node& node, const Eigen::AlignedBox3d& box, const Action& action) const {
    if (!node.box.intersects(box))
      return;
    if (node.is_leaf()) {
      for (const std::uint32_t item : items().subspan(node.first, node.count))
        action(item);
      return;
    }
    for_each_below(left(node), box, action);
    for_each_below(right(node), box, action);
  }

  void split(std::uint32_t node, std::size_t first, std::size_t count, const Source& source);

  std::vector<Node> nodes_;
  std::vector<std::uint32_t> items_;
  std::vector<std::uint32_t> leaves_;  ///< the leaf of each item
};

}  // namespace fringe::detail
