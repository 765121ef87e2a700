#pragma once

#include <vector>

#include <Eigen/Cholesky>
#include <Eigen/Core>

#include "bem/panel_equations.hpp"

namespace fringe::detail {

/// The space of the two-level preconditioner's coarse solve: all functions of the faces and one density on
/// each group of panels, solved for by Cholesky factorisation. Its unknowns are those of the coarse space,
/// functions of faces before groups, and then the faces' other functions. Together with the inverses of the
/// groups' diagonal blocks it nearly inverts the whole matrix.
class NestedSpace {
 public:
  explicit NestedSpace(const PanelEquations& equations);

  bool is_positive_definite() const { return is_positive_definite_; }

  /// Returns the fraction of its group's area that each panel has.
  const Eigen::VectorXd& shares() const { return shares_; }

  /// Returns the charges for a right-hand side. `smaller` receives a column whose scalar products with those
  /// of other right-hand sides are the energies in the coarse space.
  Eigen::VectorXd solve(const Eigen::VectorXd& right_side, Eigen::VectorXd& smaller) const;

  /// Applies the two-level preconditioner: adds the solution in this space and those of each group's panels.
  Eigen::VectorXd preconditioned(const Eigen::VectorXd& residual) const;

 private:
  Eigen::MatrixXd matrix();
  Eigen::Index place(std::size_t function) const;
  Eigen::VectorXd restricted(const Eigen::VectorXd& full) const;
  Eigen::VectorXd prolonged(const Eigen::VectorXd& nested) const;

  const PanelEquations& equations_;
  Eigen::Index group_count_;
  Eigen::Index coarse_;
  Eigen::VectorXd shares_;
  std::vector<Eigen::LLT<Eigen::MatrixXd>> groups_;  ///< the diagonal block of each group's panels
  Eigen::LLT<Eigen::MatrixXd> factor_;
  bool is_positive_definite_ = true;
};

}  // namespace fringe::detail
