#pragma once

#include <vector>

#include <Eigen/Core>

#include "bem/panel_equations.hpp"
#include "numeric/cholesky.hpp"

namespace fringe::detail {

/// The space of the two-level preconditioner's coarse solve: all functions of the faces and one density on
/// each group of panels, solved for by Cholesky factorisation. Its unknowns are those of the coarse space,
/// functions of faces before groups, and then the faces' other functions. Together with the inverses of the
/// groups' diagonal blocks it nearly inverts the whole matrix.
class TwoLevelPreconditioner {
 public:
  /// `tolerance` is that of the panels' quadratures. If it is fine and a matrix is not positive definite,
  /// functions that depend on others are left out: those of coincident panels.
  TwoLevelPreconditioner(const PanelEquations& equations, double tolerance);

  bool is_positive_definite() const { return is_positive_definite_; }

  /// Returns the fraction of its group's area that each panel has.
  const Eigen::VectorXd& shares() const { return shares_; }

  /// Returns the charges for a right-hand side. `energy_roots` receives a column whose scalar products with
  /// those of other right-hand sides are the energies in the coarse space.
  Eigen::VectorXd solve(const Eigen::VectorXd& right_side, Eigen::VectorXd& energy_roots) const;

  /// Applies the two-level preconditioner: adds the solution in this space and those of each group's panels.
  Eigen::VectorXd apply(const Eigen::VectorXd& residual) const;

 private:
  Eigen::MatrixXd matrix() const;
  Eigen::Index place(std::size_t function) const;
  Eigen::VectorXd restricted(const Eigen::VectorXd& full) const;
  Eigen::VectorXd prolonged(const Eigen::VectorXd& coarse) const;

  const PanelEquations& equations_;
  Eigen::Index group_count_;
  Eigen::Index coarse_;
  Eigen::VectorXd shares_;
  std::vector<Cholesky> groups_;  ///< the diagonal block of each group's panels
  Cholesky factor_;
  bool is_positive_definite_ = true;
};

/// The charges of all unknowns, with one column for every conductor at unit potential.
struct ConjugateGradientSolution {
  bool positive_definite = true;  ///< false if a step shows otherwise; then nothing else is set
  Eigen::MatrixXd charges;
  Eigen::MatrixXd residuals;
  Eigen::VectorXd decrements;    ///< the energy-norm decrement of the last step, for each column
  Eigen::MatrixXd energy_roots;  ///< columns whose scalar products are the energies in the coarse space

  /// Returns the energies of all pairs of columns, whose errors are of second order in the residuals.
  Eigen::MatrixXd energies(const Eigen::MatrixXd& net) const;
  /// Returns the error of the energies that the iterations may have left.
  Eigen::MatrixXd iteration_error() const;
};

/// Solves for the charges by preconditioned conjugate gradients. Starts from the coarse solve and stops when
/// a step changes a capacitance by less than `accuracy` times its value.
ConjugateGradientSolution solve_by_conjugate_gradients(const PanelEquations& equations,
                                                       const TwoLevelPreconditioner& preconditioner,
                                                       double accuracy);

}  // namespace fringe::detail
