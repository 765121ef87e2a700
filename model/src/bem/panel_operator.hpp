#pragma once

#include <memory>
#include <vector>

#include <Eigen/Core>

#include "bem/hierarchical_matrix.hpp"
#include "bem/panel_mesh.hpp"

namespace fringe::detail {

/// The single-layer matrix of all panels of a mesh, with unit charges, as a hierarchical matrix
/// (model/BOUNDARY_ELEMENTS.md, section 9).
class PanelOperator {
 public:
  /// Assembles the matrix. `tolerance` is the error aimed at for each element. Elements between panels near
  /// each other that have not changed since the last refinement are taken from `before`, the operator of that
  /// mesh; null: there is none.
  PanelOperator(const PanelMesh& mesh, double tolerance, const PanelOperator* before, std::size_t threads);

  const ClusterTree& tree() const { return *tree_; }
  /// The matrix in the order of the tree.
  const HierarchicalMatrix& matrix() const { return matrix_; }

  /// Returns the block of a group's panels with each other.
  Eigen::MatrixXd block_of_group(const PanelGroup& group) const;
  /// Returns the block of some panels with each other, in their order.
  Eigen::MatrixXd block(const std::vector<Eigen::Index>& panels) const;
  /// Returns the interaction of a panel with itself.
  double self(std::size_t panel) const;

  /// Returns the block between two leaves near each other, given by their positions, of which the first or
  /// the second has the rows; else null.
  const DenseBlock* near_block(std::size_t leaf, std::size_t other) const;
  /// Returns the leaves near a leaf, and itself, by their positions.
  std::vector<std::size_t> leaves_near(std::size_t leaf) const;

  /// Multiplies the interactions of all panels with themselves.
  void scale_diagonal(double factor) { matrix_.scale_diagonal(factor); }

  /// Returns the potentials on all panels of charges on all panels, in the order of the mesh.
  Eigen::MatrixXd apply(const Eigen::MatrixXd& charges) const;

 private:
  /// Returns the address of the element of two places whose leaves are near each other; else null.
  const float* near_element(Eigen::Index a, Eigen::Index b) const;

  std::shared_ptr<const ClusterTree> tree_;
  HierarchicalMatrix matrix_;
  /// For each leaf, the near blocks by the other leaf's position, sorted.
  std::vector<std::vector<std::pair<std::size_t, std::size_t>>> near_of_leaf_;
};

}  // namespace fringe::detail
