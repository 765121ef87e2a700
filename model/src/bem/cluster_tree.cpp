#include "bem/cluster_tree.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "bem/panel_quadrature.hpp"

namespace fringe::detail {
namespace {

using Eigen::AlignedBox3d;
using Eigen::Index;

/// Largest number of groups in a leaf. Smaller leaves make more blocks of lower efficiency, larger ones more
/// elements that are not compressed.
constexpr Index leaf_groups = 12;

/// Number of groups whose order is arbitrary: below a leaf, too, those that follow each other are close.
constexpr std::size_t ordered_groups = 2;

/// Largest ratio of the smaller cluster's diameter to the distance of both at which their block has low rank.
constexpr double admissible_ratio = 1.2;

class PairSearch {
 public:
  PairSearch(const std::vector<TreeCluster>& clusters, double tolerance) : clusters_(clusters) {
    for (std::size_t k = 0; k < far_degrees.size(); ++k)
      ratios_[k] = far_ratio(tolerance, far_degrees[k]);
  }

  ClusterPairs pairs;

  void visit(std::size_t first, std::size_t second) {
    const auto [a, b] = std::minmax(first, second);
    const TreeCluster &one = clusters_[a], &other = clusters_[b];
    if (a == b) {
      if (one.is_leaf()) {
        pairs.near.push_back({a, b, 0});
        return;
      }
      visit(one.left, one.left);
      visit(one.left, one.left + 1);
      visit(one.left + 1, one.left + 1);
      return;
    }
    if (const int degree = far_degree(one, other); degree > 0) {
      pairs.far.push_back({a, b, degree});
      return;
    }
    if (one.is_leaf() && other.is_leaf()) {
      pairs.near.push_back({a, b, 0});
      return;
    }
    const bool divide_a = other.is_leaf() || (!one.is_leaf() && diameter(one) >= diameter(other));
    const std::size_t left = divide_a ? one.left : other.left, rest = divide_a ? b : a;
    visit(left, rest);
    visit(left + 1, rest);
  }

 private:
  static double diameter(const TreeCluster& cluster) { return cluster.box.diagonal().norm(); }

  int far_degree(const TreeCluster& a, const TreeCluster& b) const {
    const double distance = std::sqrt(a.box.squaredExteriorDistance(b.box));
    if (!(std::min(diameter(a), diameter(b)) <= admissible_ratio * distance))
      return 0;
    const double between = std::sqrt(a.centres.squaredExteriorDistance(b.centres));
    for (std::size_t k = 0; k < far_degrees.size(); ++k)
      if (a.largest_radius + b.largest_radius <= ratios_[k] * between)
        return far_degrees[k];
    return 0;
  }

  const std::vector<TreeCluster>& clusters_;
  std::array<double, far_degrees.size()> ratios_{};
};

}  // namespace

ClusterTree::ClusterTree(const PanelMesh& mesh) {
  std::vector<AlignedBox3d> boxes;
  std::vector<Eigen::Vector3d> centres;
  for (const PanelGroup& group : mesh.groups()) {
    AlignedBox3d& box = boxes.emplace_back();
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (std::size_t k = group.first; k < group.first + group.count; ++k) {
      const Panel& panel = mesh.panels()[k];
      for (const Eigen::Vector3d& corner : panel.corners)
        box.extend(corner);
      sum += panel.centre;
    }
    centres.emplace_back(sum / static_cast<double>(group.count));
  }
  const BoxTree tree(boxes, centres, ordered_groups);
  places_.resize(mesh.panels().size());
  leaf_of_.resize(mesh.panels().size());
  first_panel_.push_back(0);
  for (const std::uint32_t item : tree.items()) {
    const PanelGroup& group = mesh.groups()[item];
    groups_.push_back(static_cast<Index>(item));
    for (std::size_t k = group.first; k < group.first + group.count; ++k) {
      places_[k] = static_cast<Index>(panels_.size());
      panels_.push_back(static_cast<Index>(k));
    }
    first_panel_.push_back(static_cast<Index>(panels_.size()));
  }
  clusters_.emplace_back();
  add(0, tree, tree.root(), {0, static_cast<Index>(groups_.size())}, mesh);
}

void ClusterTree::add(std::size_t cluster, const BoxTree& tree, const BoxTree::Node& node,
                      ClusterRange groups, const PanelMesh& mesh) {
  TreeCluster own{.groups = groups, .panels = {}, .box = node.box, .centres = {}};
  own.panels.first = first_panel_[static_cast<std::size_t>(groups.first)];
  own.panels.count = first_panel_[static_cast<std::size_t>(groups.first + groups.count)] - own.panels.first;
  if (node.is_leaf() || groups.count <= leaf_groups) {
    for (Index place = own.panels.first; place < own.panels.first + own.panels.count; ++place) {
      const Panel& panel = mesh.panels()[static_cast<std::size_t>(panels_[static_cast<std::size_t>(place)])];
      own.centres.extend(panel.centre);
      own.largest_radius = std::max(own.largest_radius, panel.radius);
      leaf_of_[static_cast<std::size_t>(place)] = leaves_.size();
    }
    leaves_.push_back(cluster);
    clusters_[cluster] = own;
    return;
  }
  own.left = clusters_.size();
  clusters_.resize(clusters_.size() + 2);
  const Index half = groups.count / 2;
  add(own.left, tree, tree.left(node), {groups.first, half}, mesh);
  add(own.left + 1, tree, tree.right(node), {groups.first + half, groups.count - half}, mesh);
  const TreeCluster &left = clusters_[own.left], &right = clusters_[own.left + 1];
  own.centres = left.centres.merged(right.centres);
  own.largest_radius = std::max(left.largest_radius, right.largest_radius);
  clusters_[cluster] = own;
}

ClusterPairs cluster_pairs(const ClusterTree& tree, double tolerance) {
  PairSearch search(tree.clusters(), tolerance);
  search.visit(0, 0);
  return std::move(search.pairs);
}

}  // namespace fringe::detail
