#include "bem/cluster_tree.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "bem/panel_quadrature.hpp"
#include "geometry/box_tree.hpp"

namespace fringe::detail {
namespace {

using Eigen::Index;

/// Largest number of groups in a leaf. Smaller leaves make more blocks of lower efficiency, larger ones more
/// elements that are not compressed.
constexpr Index leaf_groups = 12;

/// Number of groups whose order is arbitrary: below a leaf, too, those that follow each other are close.
constexpr std::size_t ordered_groups = 2;

/// Largest ratio of the smaller cluster's diameter to the distance of both at which their block has low rank.
constexpr double admissible_ratio = 1.2;

/// Ratio of a cluster's largest panel to the cluster above which that panel decides what is far from it, and
/// of panels that are parted from it then: their own interactions reach less far.
constexpr double decisive = 0.2, smaller = 0.5;

/// Bisects groups at the median along the longest side. Returns the size of the first part.
std::size_t bisect(std::span<PlacedGroup> groups) {
  const std::size_t half = groups.size() / 2;
  split_at_median(
      groups, half, [](const PlacedGroup& group) -> const Eigen::Vector3d& { return group.centre; },
      [](const PlacedGroup& group) { return group.group; });
  return half;
}

/// Parts the groups of a cluster by size if the largest ones are decisive, else by place. Returns the size of
/// the first part; 0 if the groups make a leaf.
std::size_t divide(std::span<PlacedGroup> groups) {
  double largest = 0;
  Eigen::AlignedBox3d box;
  for (const PlacedGroup& group : groups) {
    largest = std::max(largest, group.radius);
    box.extend(group.centre);
  }
  if (largest > decisive * box.diagonal().norm()) {
    const auto small = std::stable_partition(groups.begin(), groups.end(), [&](const PlacedGroup& group) {
      return group.radius > smaller * largest;
    });
    if (small != groups.end())
      return static_cast<std::size_t>(small - groups.begin());
  }
  return static_cast<Index>(groups.size()) <= leaf_groups ? 0 : bisect(groups);
}

/// Orders the groups of a leaf such that those that follow each other are close.
void order(std::span<PlacedGroup> groups) {
  if (groups.size() <= ordered_groups)
    return;
  const std::size_t half = bisect(groups);
  order(groups.first(half));
  order(groups.subspan(half));
}

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
    if (are_separated(one, other)) {
      pairs.far.push_back({a, b, far_degree(one, other)});
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

  static bool are_separated(const TreeCluster& a, const TreeCluster& b) {
    const double distance = std::sqrt(a.box.squaredExteriorDistance(b.box));
    return std::min(diameter(a), diameter(b)) <= admissible_ratio * distance;
  }

  int far_degree(const TreeCluster& a, const TreeCluster& b) const {
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

ClusterTree::ClusterTree(const PanelMesh& mesh)
    : places_(mesh.panels().size()), leaf_of_(mesh.panels().size()) {
  std::vector<PlacedGroup> groups;
  for (std::size_t k = 0; k < mesh.groups().size(); ++k) {
    const PanelGroup& group = mesh.groups()[k];
    PlacedGroup placed{k, Eigen::Vector3d::Zero(), 0};
    for (std::size_t member = group.first; member < group.first + group.count; ++member) {
      placed.centre += mesh.panels()[member].centre / static_cast<double>(group.count);
      placed.radius = std::max(placed.radius, mesh.panels()[member].radius);
    }
    groups.push_back(placed);
  }
  clusters_.emplace_back();
  add(0, groups, mesh);
}

void ClusterTree::add(std::size_t cluster, std::span<PlacedGroup> groups, const PanelMesh& mesh) {
  TreeCluster own;
  own.groups = {index_of(groups_.size()), index_of(groups.size())};
  own.panels.first = index_of(panels_.size());
  const std::size_t first = divide(groups);
  if (first == 0) {
    order(groups);
    for (const PlacedGroup& placed : groups) {
      const PanelGroup& group = mesh.groups()[placed.group];
      groups_.push_back(index_of(placed.group));
      for (std::size_t member = group.first; member < group.first + group.count; ++member) {
        const Panel& panel = mesh.panels()[member];
        for (const Eigen::Vector3d& corner : panel.corners)
          own.box.extend(corner);
        own.centres.extend(panel.centre);
        own.largest_radius = std::max(own.largest_radius, panel.radius);
        places_[member] = index_of(panels_.size());
        leaf_of_[panels_.size()] = leaves_.size();
        panels_.push_back(index_of(member));
      }
    }
    own.panels.count = index_of(panels_.size()) - own.panels.first;
    leaves_.push_back(cluster);
    clusters_[cluster] = own;
    return;
  }
  own.left = clusters_.size();
  clusters_.resize(clusters_.size() + 2);
  add(own.left, groups.first(first), mesh);
  add(own.left + 1, groups.subspan(first), mesh);
  const TreeCluster &left = clusters_[own.left], &right = clusters_[own.left + 1];
  own.panels.count = left.panels.count + right.panels.count;
  own.box = left.box.merged(right.box);
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
