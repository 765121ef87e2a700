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
  // Eigen cannot take rows of a matrix without columns.
  for (Index k = 0; k < (factor.cols() > 0 ? range.count : 0); ++k) {
    const Index unknown = range.first + k, target = restriction.target[static_cast<std::size_t>(unknown)];
    if (target >= 0)
      result.row(target - first) += restriction.weights[unknown] * factor.row(k);
  }
  return result;
}

}  // namespace

HierarchicalMatrix::HierarchicalMatrix(std::vector<ClusterRange> clusters, std::vector<std::size_t> leaves,
                                       std::vector<LowRankBlock> far, std::vector<DenseBlock> near,
                                       std::size_t threads)
    : clusters_(std::move(clusters)), leaves_(std::move(leaves)), far_(std::move(far)),
      near_(std::move(near)), own_(leaves_.size()), threads_(threads) {
  std::vector<std::size_t> position(clusters_.size(), 0);
  for (std::size_t leaf = 0; leaf < leaves_.size(); ++leaf) {
    position[leaves_[leaf]] = leaf;
    size_ += clusters_[leaves_[leaf]].count;
  }
  for (std::size_t block = 0; block < near_.size(); ++block)
    if (near_[block].a == near_[block].b)
      own_[position[near_[block].a]] = block;
  divide();
}

/// Divides the blocks into parts of the same number of values, for the threads of a product.
void HierarchicalMatrix::divide() {
  /// Number of parts: enough for sixteen threads. It does not depend on theirs, so that the sums do not.
  constexpr std::size_t most_parts = 16;
  parts_ = {{0, 0}};
  const std::size_t values = bytes() / sizeof(float);
  std::size_t passed = 0;
  const auto pass = [&](Index count) {
    passed += static_cast<std::size_t>(count);
    return passed * most_parts >= values * parts_.size();
  };
  for (std::size_t k = 0; k < near_.size(); ++k)
    if (pass(near_[k].values.size()))
      parts_.push_back({k + 1, 0});
  for (std::size_t k = 0; k < far_.size(); ++k)
    if (pass(far_[k].rows.size() + far_[k].columns.size()))
      parts_.push_back({near_.size(), k + 1});
  parts_.back() = {near_.size(), far_.size()};
}

MatrixXd HierarchicalMatrix::apply(const MatrixXd& factors) const {
  const auto of = [&](auto&& vectors, std::size_t cluster) {
    return vectors.middleRows(clusters_[cluster].first, clusters_[cluster].count);
  };
  std::vector<MatrixXd> sums(parts_.size() - 1);
  parallel_for(sums.size(), threads_, [&](std::size_t part) {
    MatrixXd sum = MatrixXd::Zero(size_, factors.cols());
    for (std::size_t k = parts_[part].near; k < parts_[part + 1].near; ++k) {
      const auto& [a, b, values] = near_[k];
      add_product(values, of(factors, b), of(sum, a));
      if (a != b)
        add_transposed_product(values, of(factors, a), of(sum, b));
    }
    MatrixXd product;
    for (std::size_t k = parts_[part].far; k < parts_[part + 1].far; ++k) {
      const auto& [a, b, rows, columns] = far_[k];
      product.setZero(rows.cols(), factors.cols());
      add_transposed_product(columns, of(factors, b), product);
      add_product(rows, product, of(sum, a));
      product.setZero();
      add_transposed_product(rows, of(factors, a), product);
      add_product(columns, product, of(sum, b));
    }
    sums[part] = std::move(sum);
  });
  MatrixXd result = MatrixXd::Zero(size_, factors.cols());
  for (const MatrixXd& sum : sums)
    result += sum;
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
  const auto range_of = [&](std::size_t cluster) -> ClusterRange {
    ClusterRange range{rows, 0};
    Index last = -1;
    for (Index k = 0; k < clusters_[cluster].count; ++k)
      if (const Index target = restriction.target[static_cast<std::size_t>(clusters_[cluster].first + k)];
          target >= 0) {
        range.first = std::min(range.first, target);
        last = std::max(last, target);
      }
    return last < 0 ? ClusterRange{0, 0} : ClusterRange{range.first, last - range.first + 1};
  };
  const auto restricted = [&](const MatrixXd& factor, std::size_t cluster) -> MatrixXd {
    const ClusterRange range = range_of(cluster);
    return restricted_rows(factor, clusters_[cluster], restriction, range.first, range.count);
  };
  std::vector<MatrixXd> parts(near_.size() + far_.size());
  parallel_for(parts.size(), threads_, [&](std::size_t k) {
    if (k < near_.size()) {
      const auto& [a, b, values] = near_[k];
      parts[k] = restricted(restricted(values.cast<double>(), a).transpose(), b).transpose();
    } else {
      const LowRankBlock& far = far_[k - near_.size()];
      parts[k] = restricted(far.rows.cast<double>(), far.a) *
                 restricted(far.columns.cast<double>(), far.b).transpose();
    }
  });
  MatrixXd result = MatrixXd::Zero(rows, rows);
  for (std::size_t k = 0; k < parts.size(); ++k) {
    const std::size_t a = k < near_.size() ? near_[k].a : far_[k - near_.size()].a;
    const std::size_t b = k < near_.size() ? near_[k].b : far_[k - near_.size()].b;
    result.block(range_of(a).first, range_of(b).first, parts[k].rows(), parts[k].cols()) += parts[k];
    if (a != b)
      result.block(range_of(b).first, range_of(a).first, parts[k].cols(), parts[k].rows()) +=
          parts[k].transpose();
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
