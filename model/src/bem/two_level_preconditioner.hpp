#pragma once

#include <vector>

#include <Eigen/Core>

#include "bem/bordered_matrix.hpp"
#include "numeric/cholesky.hpp"

namespace fringe::detail {

/// Combinations of the unknowns of a matrix, and the matrix of these.
struct CoarseSpace {
  Restriction restriction;
  Eigen::MatrixXd matrix;
};

/// Returns the coarse space of the unknowns of a matrix, panels or groups of them: one density on each
/// `together` of a leaf that follow each other, for each body on them. `areas` and `bodies` are those of the
/// unknowns.
CoarseSpace coarse_space(const HierarchicalMatrix& matrix, const Eigen::VectorXd& areas,
                         const std::vector<std::size_t>& bodies, Eigen::Index together);

/// An additive Schwarz method of two levels for the charges of conductors: adds the solution in a coarse
/// space, by one Cholesky factorisation, and those for the unknowns of each leaf alone. Leaves contain panels
/// of all bodies close by, so that panels on both sides of a narrow gap are solved for together.
class TwoLevelPreconditioner {
 public:
  /// The whole coarse space consists of the matrix' functions and of combinations of its unknowns. Matrix and
  /// combinations have to live as long as this.
  /// What the matrix leaves out is left out here, and so are combinations of only that. `tolerance` is that
  /// of the quadratures: if it is fine and a block is not positive definite, functions that depend on others
  /// are left out, those of coincident panels.
  TwoLevelPreconditioner(const BorderedMatrix& matrix, const CoarseSpace& coarse, double tolerance,
                         std::size_t threads);

  /// Returns false if a block is not positive definite: the quadratures are too coarse.
  bool is_positive_definite() const { return is_positive_definite_; }

  /// Applies the method to residuals, the columns.
  Eigen::MatrixXd apply(const Eigen::MatrixXd& residuals) const;

 private:
  const BorderedMatrix& matrix_;
  const Restriction& restriction_;
  Cholesky coarse_;
  std::vector<Cholesky> leaves_;
  std::size_t threads_;
  bool is_positive_definite_ = true;
};

}  // namespace fringe::detail
