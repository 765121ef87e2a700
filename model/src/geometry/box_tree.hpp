#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Geometry>

namespace fringe::detail {

/// A bounding volume hierarchy: a binary tree of axis-aligned boxes over numbered items (thesis 3.3, last
/// paragraph). A node's box holds those of the items below it.
class BoxTree {
 public:
  struct Node {
    Eigen::AlignedBox3d box;
    std::uint32_t parent;  ///< of the root: itself
    std::uint32_t left;    ///< 0 for a leaf; the right child is next to the left one
    std::uint32_t first;   ///< of a leaf: the place of its first item in items()
    std::uint32_t count;   ///< of a leaf: how many items it has

    bool is_leaf() const { return left == 0; }
  };

  BoxTree() = default;

  /// Makes a tree with one leaf for each box. Items are numbered as their boxes.
  explicit BoxTree(std::span<const Eigen::AlignedBox3d> boxes);

  /// Halves the items at the median of their points until no leaf has more than `leaf_size`.
  BoxTree(std::span<const Eigen::AlignedBox3d> boxes, std::span<const Eigen::Vector3d> points,
          std::size_t leaf_size);

  bool empty() const { return nodes_.empty(); }
  const Node& root() const { return nodes_.front(); }
  const Node& left(const Node& node) const { return nodes_[node.left]; }
  const Node& right(const Node& node) const { return nodes_[node.left + 1]; }

  /// The numbers of all items, those of a leaf one after the other.
  std::span<const std::uint32_t> items() const { return items_; }
  /// The item of a leaf that has one only.
  std::uint32_t item(const Node& leaf) const { return items_[leaf.first]; }
  /// The leaf of an item.
  const Node& leaf_of(std::size_t item) const { return nodes_[leaves_[item]]; }

  /// Gives an item of a leaf of its own another box. The boxes above it grow or shrink with it; the tree's
  /// shape stays.
  void move(std::size_t item, const Eigen::AlignedBox3d& box);

  /// The sum of the nodes' surfaces, to which the cost of a search is roughly proportional.
  double cost() const;

 private:
  struct Source {
    std::span<const Eigen::AlignedBox3d> boxes;
    std::span<const Eigen::Vector3d> points;
    std::size_t leaf_size;
  };

  void split(std::uint32_t node, std::size_t first, std::size_t count, const Source& source);

  std::vector<Node> nodes_;
  std::vector<std::uint32_t> items_;
  std::vector<std::uint32_t> leaves_;  ///< by item
};

}  // namespace fringe::detail
