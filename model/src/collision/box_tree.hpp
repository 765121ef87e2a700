#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Geometry>

namespace fringe::detail {

/// A binary tree of axis-aligned boxes over numbered items (thesis 3.3, last paragraph). A node's box holds
/// those below it.
class BoxTree {
 public:
  struct Node {
    Eigen::AlignedBox3d box;
    std::uint32_t parent;  ///< of the root: itself
    std::uint32_t left;    ///< the right one is next to it
    std::uint32_t item;    ///< of a leaf, `none` of others

    bool is_leaf() const { return item != none; }
  };

  static constexpr std::uint32_t none = static_cast<std::uint32_t>(-1);

  BoxTree() = default;

  /// Items are numbered as their boxes.
  explicit BoxTree(std::span<const Eigen::AlignedBox3d> boxes);

  bool empty() const { return nodes_.empty(); }
  const Node& root() const { return nodes_.front(); }
  const Node& left(const Node& node) const { return nodes_[node.left]; }
  const Node& right(const Node& node) const { return nodes_[node.left + 1]; }
  const Node& leaf_of(std::size_t item) const { return nodes_[leaves_[item]]; }

  /// Gives an item another box. The boxes above it grow or shrink with it; the tree's shape stays.
  void move(std::size_t item, const Eigen::AlignedBox3d& box);

  /// The sum of the nodes' surfaces, to which the cost of a search is roughly proportional.
  double cost() const;

 private:
  void split(std::uint32_t node, std::span<std::uint32_t> items, std::span<const Eigen::AlignedBox3d> boxes);

  std::vector<Node> nodes_;
  std::vector<std::uint32_t> leaves_;
};

}  // namespace fringe::detail
