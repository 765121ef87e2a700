#include "bem/hierarchical_matrix.hpp"

#include <algorithm>
#include <utility>

#include "numeric/parallel.hpp"
#include "numeric/products.hpp"

namespace fringe::detail {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::MatrixXf;

/// Adds the rows of `factor` to the targets' rows; the first target is row 0.
MatrixXd restricted_rows(const MatrixXd& factor, ClusterRange range, const Restriction& restriction,
                         Index first, Index count) {
  MatrixXd result = MatrixXd::Zero(count, factor.cols());
  for (Index k = 0; k < range.count; ++k) {
    const Index unknown = range.first + k;
    result.row(restriction.target[static_cast<std::size_t>(unknown)] - first) +=
        restriction.weights[unknown] * factor.row(k);
  }
  return result;
}

/// The targets of a cluster's unknowns, when these are not consecutive.
struct Targets {
  std::vector<Index> indices;  ///< sorted
  Restriction own;             ///< to the positions in `indices`

  Targets(ClusterRange range, const Restriction& restriction) {
    const auto begin = restriction.target.begin() + range.first;
    indices.assign(begin, begin + range.count);
    std::sort(indices.begin(), indices.end());
    indices.erase(std::unique(indices.begin(), indices.end()), indices.end());
    for (Index k = 0; k < range.count; ++k)
      own.target.push_back(std::lower_bound(indices.begin(), indices.end(), begin[k]) - indices.begin());
    own.weights = restriction.weights.segment(range.first, range.count);
  }

  MatrixXd rows(const MatrixXd& factor) const {
    return restricted_rows(factor, {0, factor.rows()}, own, 0, static_cast<Index>(indices.size()));
  }
};

}  // namespace

HierarchicalMatrix::HierarchicalMatrix(std::vector<ClusterRange> clusters, std::vector<std::size_t> leaves,
                                       std::vector<LowRankBlock> far, std::vector<DenseBlock> near,
                                       std::size_t threads)
    : clusters_(std::move(clusters)), leaves_(std::move(leaves)), far_(std::move(far)),
      near_(std::move(near)), own_(leaves_.size()), far_uses_(leaves_.size()), near_uses_(leaves_.size()),
      threads_(threads) {
  std::vector<std::size_t> position(clusters_.size(), 0);
  std::vector<Index> begins;
  std::vector<std::size_t> order(leaves_.size());
  for (std::size_t leaf = 0; leaf < leaves_.size(); ++leaf) {
    position[leaves_[leaf]] = leaf;
    order[leaf] = leaf;
    size_ += clusters_[leaves_[leaf]].count;
  }
  const auto begin_of = [&](std::size_t leaf) { return clusters_[leaves_[leaf]].first; };
  std::sort(order.begin(), order.end(),
            [&](std::size_t a, std::size_t b) { return begin_of(a) < begin_of(b); });
  begins.reserve(order.size());
  for (const std::size_t leaf : order)
    begins.push_back(begin_of(leaf));
  const auto add_far = [&](std::size_t block, std::size_t cluster, bool as_rows) {
    const ClusterRange range = clusters_[cluster];
    auto at = static_cast<std::size_t>(std::lower_bound(begins.begin(), begins.end(), range.first) -
                                       begins.begin());
    for (; at < begins.size() && begins[at] < range.first + range.count; ++at)
      far_uses_[order[at]].push_back({block, as_rows});
  };
  for (std::size_t block = 0; block < far_.size(); ++block) {
    add_far(block, far_[block].a, true);
    add_far(block, far_[block].b, false);
  }
  for (std::size_t block = 0; block < near_.size(); ++block) {
    const std::size_t a = position[near_[block].a], b = position[near_[block].b];
    near_uses_[a].push_back({block, true});
    if (a == b)
      own_[a] = block;
    else
      near_uses_[b].push_back({block, false});
  }
}

MatrixXd HierarchicalMatrix::apply(const MatrixXd& factors) const {
  /// Number of low-rank blocks in one call.
  constexpr std::size_t together = 64;
  struct Products {
    MatrixXd of_rows;
    MatrixXd of_columns;
  };
  std::vector<Products> products(far_.size());
  parallel_for((far_.size() + together - 1) / together, threads_, [&](std::size_t part) {
    for (std::size_t k = part * together; k < std::min((part + 1) * together, far_.size()); ++k) {
      const LowRankBlock& block = far_[k];
      const ClusterRange a = clusters_[block.a], b = clusters_[block.b];
      products[k] = {MatrixXd::Zero(block.rows.cols(), factors.cols()),
                     MatrixXd::Zero(block.rows.cols(), factors.cols())};
      add_transposed_product(block.rows, factors.middleRows(a.first, a.count), products[k].of_rows);
      add_transposed_product(block.columns, factors.middleRows(b.first, b.count), products[k].of_columns);
    }
  });
  MatrixXd result = MatrixXd::Zero(size_, factors.cols());
  parallel_for(leaves_.size(), threads_, [&](std::size_t leaf) {
    const ClusterRange range = clusters_[leaves_[leaf]];
    MatrixXd sum = MatrixXd::Zero(range.count, factors.cols());
    for (const Use& use : near_uses_[leaf]) {
      const DenseBlock& block = near_[use.block];
      const ClusterRange other = clusters_[use.as_rows ? block.b : block.a];
      const auto of_other = factors.middleRows(other.first, other.count);
      if (use.as_rows)
        add_product(block.values, of_other, sum);
      else
        add_transposed_product(block.values, of_other, sum);
    }
    for (const Use& use : far_uses_[leaf]) {
      const LowRankBlock& block = far_[use.block];
      const MatrixXf& own = use.as_rows ? block.rows : block.columns;
      const Index offset = range.first - clusters_[use.as_rows ? block.a : block.b].first;
      const MatrixXd& product = use.as_rows ? products[use.block].of_columns : products[use.block].of_rows;
      add_product(own.middleRows(offset, range.count), product, sum);
    }
    result.middleRows(range.first, range.count) = sum;
  });
  return result;
}

HierarchicalMatrix HierarchicalMatrix::restricted(const Restriction& restriction,
                                                  std::vector<ClusterRange> clusters) const {
  std::vector<LowRankBlock> far(far_.size());
  std::vector<DenseBlock> near(near_.size());
  const auto rows = [&](const MatrixXd& factor, std::size_t cluster) -> MatrixXd {
    return restricted_rows(factor, clusters_[cluster], restriction, clusters[cluster].first,
                           clusters[cluster].count);
  };
  parallel_for(far_.size(), threads_, [&](std::size_t k) {
    const LowRankBlock& block = far_[k];
    far[k] = {block.a, block.b, rows(block.rows.cast<double>(), block.a).cast<float>(),
              rows(block.columns.cast<double>(), block.b).cast<float>()};
  });
  parallel_for(near_.size(), threads_, [&](std::size_t k) {
    const DenseBlock& block = near_[k];
    const MatrixXd of_rows = rows(block.values.cast<double>(), block.a);
    near[k] = {block.a, block.b, rows(of_rows.transpose(), block.b).transpose().cast<float>()};
  });
  return {std::move(clusters), leaves_, std::move(far), std::move(near), threads_};
}

MatrixXd HierarchicalMatrix::dense_restricted(const Restriction& restriction, Index rows) const {
  struct Part {
    std::vector<Index> rows;
    std::vector<Index> columns;
    MatrixXd values;
    bool is_diagonal;
  };
  std::vector<Part> parts(near_.size() + far_.size());
  parallel_for(parts.size(), threads_, [&](std::size_t k) {
    const bool is_near = k < near_.size();
    const LowRankBlock* const far = is_near ? nullptr : &far_[k - near_.size()];
    Targets a(clusters_[is_near ? near_[k].a : far->a], restriction);
    Targets b(clusters_[is_near ? near_[k].b : far->b], restriction);
    MatrixXd values =
        is_near
            ? MatrixXd(b.rows(a.rows(near_[k].values.cast<double>()).transpose()).transpose())
            : MatrixXd(a.rows(far->rows.cast<double>()) * b.rows(far->columns.cast<double>()).transpose());
    parts[k] = {std::move(a.indices), std::move(b.indices), std::move(values),
                is_near && near_[k].a == near_[k].b};
  });
  MatrixXd result = MatrixXd::Zero(rows, rows);
  for (const Part& part : parts)
    for (std::size_t column = 0; column < part.columns.size(); ++column)
      for (std::size_t row = 0; row < part.rows.size(); ++row) {
        const double value = part.values(static_cast<Index>(row), static_cast<Index>(column));
        result(part.rows[row], part.columns[column]) += value;
        if (!part.is_diagonal)
          result(part.columns[column], part.rows[row]) += value;
      }
  return result;
}

std::size_t HierarchicalMatrix::bytes() const {
  Index values = 0;
  for (const LowRankBlock& block : far_)
    values += block.rows.size() + block.columns.size();
  for (const DenseBlock& block : near_)
    values += block.values.size();
  return static_cast<std::size_t>(values) * sizeof(float);
}

}  // namespace fringe::detail
