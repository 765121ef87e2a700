#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Core>

#include "bem/cluster_tree.hpp"

namespace fringe::detail {

/// A block of low rank: rows·columnsᵀ.
struct LowRankBlock {
  std::size_t a;            ///< cluster of the rows
  std::size_t b;            ///< cluster of the columns
  Eigen::MatrixXf rows;     ///< a row for each row of the block
  Eigen::MatrixXf columns;  ///< a row for each column of the block
};

/// A block of which all elements are stored.
struct DenseBlock {
  std::size_t a;
  std::size_t b;
  Eigen::MatrixXf values;
};

/// A linear combination of the unknowns for each of fewer ones: those of a cluster give such of the same
/// cluster, which follow each other.
struct Restriction {
  /// For each unknown, in the order of the tree. Negative: it gives to none; only for dense_restricted().
  std::vector<Eigen::Index> target;
  Eigen::VectorXd weights;  ///< of each unknown
};

/// A symmetric matrix in blocks between clusters, of low rank where these are well separated (a hierarchical
/// matrix; Hackbusch 1999). Of the blocks (a, b) and (b, a) one is stored, in single precision: the elements'
/// quadratures are less accurate. Unknowns are in the order of the tree.
class HierarchicalMatrix {
 public:
  HierarchicalMatrix() = default;
  /// `clusters` are the unknowns of each cluster, `leaves` the clusters that together contain each unknown
  /// once.
  HierarchicalMatrix(std::vector<ClusterRange> clusters, std::vector<std::size_t> leaves,
                     std::vector<LowRankBlock> far, std::vector<DenseBlock> near, std::size_t threads);

  Eigen::Index size() const { return size_; }
  /// Returns the number of threads for a product; 0: all.
  std::size_t threads() const { return threads_; }

  /// Returns the product with vectors, the columns of `factors`.
  Eigen::MatrixXd apply(const Eigen::MatrixXd& factors) const;

  /// Returns RᵀAR as a hierarchical matrix; `clusters` are the ranges of the fewer unknowns.
  HierarchicalMatrix restricted(const Restriction& restriction, std::vector<ClusterRange> clusters) const;

  /// Returns RᵀAR, of so many rows, with all its elements.
  Eigen::MatrixXd dense_restricted(const Restriction& restriction, Eigen::Index rows) const;

  const std::vector<std::size_t>& leaves() const { return leaves_; }
  ClusterRange range(std::size_t cluster) const { return clusters_[cluster]; }
  /// Returns the block of a leaf's unknowns with each other, the leaf given by its position.
  Eigen::MatrixXd diagonal_block(std::size_t leaf) const {
    return diagonal_block(leaf, {0, near_[own_[leaf]].values.rows()});
  }
  /// Returns the block of a part of them, numbered from the leaf's first.
  Eigen::MatrixXd diagonal_block(std::size_t leaf, ClusterRange part) const {
    return near_[own_[leaf]].values.block(part.first, part.first, part.count, part.count).cast<double>();
  }
  const std::vector<DenseBlock>& near() const { return near_; }

  void scale_diagonal(double factor) {
    for (const std::size_t block : own_)
      near_[block].values.diagonal() *= static_cast<float>(factor);
  }

  /// Returns the memory of all blocks in bytes.
  std::size_t bytes() const;

 private:
  /// Where a part of the blocks begins.
  struct PartBegin {
    std::size_t near;
    std::size_t far;
  };

  void divide();

  std::vector<ClusterRange> clusters_;
  std::vector<std::size_t> leaves_;
  std::vector<LowRankBlock> far_;
  std::vector<DenseBlock> near_;
  std::vector<std::size_t> own_;  ///< for each leaf, its diagonal block in near_
  std::vector<PartBegin> parts_;  ///< of the blocks in a product, and last where they end
  Eigen::Index size_ = 0;
  std::size_t threads_ = 1;
};

}  // namespace fringe::detail
