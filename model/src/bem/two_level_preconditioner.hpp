#pragma once

#include <vector>

#include <Eigen/Core>

#include "bem/bordered_matrix.hpp"
#include "numeric/cholesky.hpp"

namespace fringe::detail {

/// An additive Schwarz method of two levels for the charges of conductors: adds the solution in a coarse
/// space, by one Cholesky factorisation, and those for the unknowns of each leaf alone. Leaves contain panels
/// of all bodies close by, so that panels on both sides of a narrow gap are solved for together.
class TwoLevelPreconditioner {
 public:
  /// The coarse space consists of the matrix' functions and of `coarse_size` combinations of its unknowns.
  /// What the matrix leaves out is left out here, and so are combinations of only that. `tolerance` is that
  /// of the quadratures: if it is fine and a block is not positive definite, functions that depend on others
  /// are left out, those of coincident panels.
  TwoLevelPreconditioner(const BorderedMatrix& matrix, Restriction coarse, Eigen::Index coarse_size,
                         double tolerance, std::size_t threads);

  /// Returns false if a block is not positive definite: the quadratures are too coarse.
  bool is_positive_definite() const { return is_positive_definite_; }

  /// Applies the method to residuals, the columns.
  Eigen::MatrixXd apply(const Eigen::MatrixXd& residuals) const;

 private:
  const BorderedMatrix& matrix_;
  Restriction restriction_;
  Cholesky coarse_;
  std::vector<Cholesky> leaves_;
  std::size_t threads_;
  bool is_positive_definite_ = true;
};

/// Returns the coarse space of the panels of a tree: one density on each cluster of about `groups_together`
/// groups, for each body on it. `areas` and `bodies` are those of the unknowns, the panels or the groups, in
/// the order of the tree.
struct CoarseSpace {
  Restriction restriction;
  Eigen::Index size = 0;
};
CoarseSpace coarse_space(const std::vector<ClusterRange>& leaves, const Eigen::VectorXd& areas,
                         const std::vector<std::size_t>& bodies, Eigen::Index together);

}  // namespace fringe::detail
