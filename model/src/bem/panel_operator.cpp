#include "bem/panel_operator.hpp"

#include <algorithm>
#include <array>
#include <numeric>
#include <optional>
#include <utility>

#include "bem/cross_approximation.hpp"
#include "bem/single_layer_panels.hpp"
#include "numeric/parallel.hpp"

namespace fringe::detail {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

/// Ratio of the error of a low-rank block to that of the quadratures.
constexpr double compression_part = 0.1;

std::vector<ClusterRange> panel_ranges(const ClusterTree& tree) {
  std::vector<ClusterRange> ranges;
  for (const TreeCluster& cluster : tree.clusters())
    ranges.push_back(cluster.panels);
  return ranges;
}

LowRankBlock low_rank_block(const ClusterPair& pair, const std::vector<TreeCluster>& clusters,
                            const std::vector<Panel>& panels, const PanelElements& elements,
                            const PointCharges* points, double tolerance) {
  const ClusterRange a = clusters[pair.a].panels, b = clusters[pair.b].panels;
  PotentialSums sums;
  const auto fill = [&](Index place, ClusterRange others, double* values) {
    const Panel& panel = panels[static_cast<std::size_t>(place)];
    const auto first = static_cast<std::size_t>(others.first), count = static_cast<std::size_t>(others.count);
    if (points != nullptr) {
      points->fill(panel, first, count, values);
      return;
    }
    elements.fill(panel, first, count, sums, nullptr, values);
    sums.flush();
  };
  const MatrixSource source{a.count, b.count,
                            [&](Index row, double* values) { fill(a.first + row, b, values); },
                            [&](Index column, double* values) { fill(b.first + column, a, values); }};
  LowRankFactors factors = cross_approximation(source, tolerance);
  return {pair.a, pair.b, factors.rows.transpose().cast<float>(), factors.columns.transpose().cast<float>()};
}

}  // namespace

PanelOperator::PanelOperator(const PanelMesh& mesh, double tolerance, const PanelOperator* before,
                             std::size_t threads)
    : tree_(std::make_shared<const ClusterTree>(mesh)) {
  const std::vector<TreeCluster>& clusters = tree_->clusters();
  std::vector<Panel> panels;
  for (const Index panel : tree_->panels())
    panels.push_back(mesh.panels()[static_cast<std::size_t>(panel)]);
  const auto place_before = [&](Index place) {
    const Index old =
        mesh.places_before()[static_cast<std::size_t>(tree_->panels()[static_cast<std::size_t>(place)])];
    return old < 0 ? old : before->tree_->places()[static_cast<std::size_t>(old)];
  };
  const ClusterPairs pairs = cluster_pairs(*tree_, tolerance);

  const PanelElements elements(panels, tolerance);
  std::vector<DenseBlock> near(pairs.near.size());
  parallel_for(near.size(), threads, [&](std::size_t block) {
    const auto& [a, b, degree] = pairs.near[block];
    const ClusterRange rows = clusters[a].panels, columns = clusters[b].panels;
    MatrixXd values(columns.count, rows.count);
    PotentialSums sums;
    for (Index row = 0; row < rows.count; ++row) {
      const Index old = before == nullptr ? -1 : place_before(rows.first + row);
      PanelElements::Known known;
      if (old >= 0)
        known = [&, old](std::size_t column) -> std::optional<double> {
          const Index old_column = place_before(static_cast<Index>(column));
          const float* const element = old_column < 0 ? nullptr : before->near_element(old, old_column);
          return element == nullptr ? std::nullopt : std::optional<double>(*element);
        };
      elements.fill(
          panels[static_cast<std::size_t>(rows.first + row)], static_cast<std::size_t>(columns.first),
          static_cast<std::size_t>(a == b ? row : columns.count), sums, known, values.col(row).data());
      if (a == b)
        values(row, row) = panel_self(panels[static_cast<std::size_t>(rows.first + row)]);
    }
    sums.flush();
    if (a == b)
      near[block] = {a, b, MatrixXd(values.selfadjointView<Eigen::Upper>()).cast<float>()};
    else
      near[block] = {a, b, values.transpose().cast<float>()};
  });

  const std::array<PointCharges, 2> points{PointCharges(panels, far_degrees[0]),
                                           PointCharges(panels, far_degrees[1])};
  std::vector<LowRankBlock> far(pairs.far.size());
  parallel_for(far.size(), threads, [&](std::size_t block) {
    const ClusterPair& pair = pairs.far[block];
    const PointCharges* const of_degree =
        pair.degree == 0 ? nullptr : &points[pair.degree == far_degrees[0] ? 0 : 1];
    far[block] = low_rank_block(pair, clusters, panels, elements, of_degree, compression_part * tolerance);
  });

  near_of_leaf_.resize(tree_->leaves().size());
  for (std::size_t block = 0; block < near.size(); ++block) {
    const std::size_t a = tree_->leaf_of(clusters[near[block].a].panels.first);
    const std::size_t b = tree_->leaf_of(clusters[near[block].b].panels.first);
    near_of_leaf_[a].emplace_back(b, block);
    if (a != b)
      near_of_leaf_[b].emplace_back(a, block);
  }
  for (auto& blocks : near_of_leaf_)
    std::sort(blocks.begin(), blocks.end());
  matrix_ =
      HierarchicalMatrix(panel_ranges(*tree_), tree_->leaves(), std::move(far), std::move(near), threads);
}

const DenseBlock* PanelOperator::near_block(std::size_t leaf, std::size_t other) const {
  const auto& blocks = near_of_leaf_[leaf];
  const auto found = std::lower_bound(blocks.begin(), blocks.end(), std::pair(other, std::size_t{0}));
  return found == blocks.end() || found->first != other ? nullptr : &matrix_.near()[found->second];
}

const float* PanelOperator::near_element(Index a, Index b) const {
  const std::size_t leaf = tree_->leaf_of(a);
  const DenseBlock* const block = near_block(leaf, tree_->leaf_of(b));
  if (block == nullptr)
    return nullptr;
  const bool as_rows = tree_->leaves()[leaf] == block->a;
  const Index row = (as_rows ? a : b) - matrix_.range(block->a).first;
  const Index column = (as_rows ? b : a) - matrix_.range(block->b).first;
  return block->values.data() + row + column * block->values.rows();
}

std::vector<std::size_t> PanelOperator::leaves_near(std::size_t leaf) const {
  std::vector<std::size_t> result;
  for (const auto& [other, block] : near_of_leaf_[leaf])
    result.push_back(other);
  return result;
}

MatrixXd PanelOperator::block_of_group(const PanelGroup& group) const {
  const Index first = tree_->places()[group.first];
  const std::size_t leaf = tree_->leaf_of(first);
  const Index offset = first - matrix_.range(tree_->leaves()[leaf]).first;
  return matrix_.diagonal_block(leaf, {offset, static_cast<Index>(group.count)});
}

MatrixXd PanelOperator::block(const std::vector<Index>& panels) const {
  // Numbered in the order of the tree, so that the parts of its blocks are small.
  std::vector<Index> order(panels.size()), rank(panels.size());
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(), [&](Index a, Index b) {
    return tree_->places()[static_cast<std::size_t>(panels[static_cast<std::size_t>(a)])] <
           tree_->places()[static_cast<std::size_t>(panels[static_cast<std::size_t>(b)])];
  });
  Restriction restriction{std::vector<Index>(tree_->panels().size(), -1),
                          Eigen::VectorXd::Ones(matrix_.size())};
  for (std::size_t k = 0; k < order.size(); ++k) {
    const auto panel = static_cast<std::size_t>(panels[static_cast<std::size_t>(order[k])]);
    restriction.target[static_cast<std::size_t>(tree_->places()[panel])] = index_of(k);
    rank[static_cast<std::size_t>(order[k])] = index_of(k);
  }
  return matrix_.dense_restricted(restriction, index_of(panels.size()))(rank, rank);
}

double PanelOperator::self(std::size_t panel) const {
  const Index place = tree_->places()[panel];
  return *near_element(place, place);
}

MatrixXd PanelOperator::apply(const MatrixXd& charges) const {
  return matrix_.apply(charges(tree_->panels(), Eigen::all))(tree_->places(), Eigen::all);
}

}  // namespace fringe::detail
