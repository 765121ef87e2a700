#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include <Eigen/Geometry>

#include "bem/panel_mesh.hpp"

namespace fringe::detail {

/// Consecutive unknowns in the order of a cluster tree.
struct ClusterRange {
  Eigen::Index first = 0;
  Eigen::Index count = 0;
};

/// Groups of panels that are close to each other, of any bodies.
struct TreeCluster {
  ClusterRange groups;
  ClusterRange panels;
  Eigen::AlignedBox3d box;      ///< contains the panels
  Eigen::AlignedBox3d centres;  ///< contains the panels' centres
  double largest_radius = 0;    ///< of a panel
  std::size_t left = 0;         ///< index of the left child, which the right one follows; 0 for a leaf

  bool is_leaf() const { return left == 0; }
};

/// A group of panels of the mesh, by its place and size.
struct PlacedGroup {
  std::size_t group;
  Eigen::Vector3d centre;
  double radius;  ///< of its largest panel
};

/// A binary tree of clusters, bisected at the median along the longest side, or by the panels' sizes where
/// the largest ones would keep a cluster near to others. Panels and groups are numbered anew such that those
/// of a cluster follow each other.
class ClusterTree {
 public:
  explicit ClusterTree(const PanelMesh& mesh);

  const std::vector<TreeCluster>& clusters() const { return clusters_; }
  /// Returns the index of each leaf.
  const std::vector<std::size_t>& leaves() const { return leaves_; }
  /// Return for each place in the order of the tree the panel or the group of the mesh.
  const std::vector<Eigen::Index>& panels() const { return panels_; }
  const std::vector<Eigen::Index>& groups() const { return groups_; }
  /// Returns for each panel of the mesh its place, and the position of its leaf in leaves().
  const std::vector<Eigen::Index>& places() const { return places_; }
  std::size_t leaf_of(Eigen::Index place) const { return leaf_of_[static_cast<std::size_t>(place)]; }

 private:
  /// Writes the cluster of groups, which it orders, and those below it.
  void add(std::size_t cluster, std::span<PlacedGroup> groups, const PanelMesh& mesh);

  std::vector<TreeCluster> clusters_;
  std::vector<std::size_t> leaves_;
  std::vector<Eigen::Index> panels_;
  std::vector<Eigen::Index> groups_;
  std::vector<Eigen::Index> places_;
  std::vector<std::size_t> leaf_of_;
};

/// Degrees of the quadrature rules on the panels of well-separated clusters, of 3 and 6 points.
inline constexpr std::array far_degrees{2, 4};

/// Two clusters a ≤ b, and the degree of the quadrature rule on their panels that suffices for the block. 0:
/// none does for all of them, and elements of panels near each other are integrated as in near blocks.
struct ClusterPair {
  std::size_t a;
  std::size_t b;
  int degree;
};

/// The blocks of a symmetric matrix between the clusters of a tree: those of well-separated clusters, and
/// those of leaves that are not.
struct ClusterPairs {
  std::vector<ClusterPair> far;
  std::vector<ClusterPair> near;
};

/// Divides the matrix into blocks. `tolerance` is the relative error of an element that a rule may have.
ClusterPairs cluster_pairs(const ClusterTree& tree, double tolerance);

}  // namespace fringe::detail
