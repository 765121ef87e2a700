#pragma once

#include <Eigen/Core>

#include "bem/bordered_matrix.hpp"
#include "bem/two_level_preconditioner.hpp"

/// Solutions in one space of charges, the whole or the coarse one, without the targets and with them
/// (model/BOUNDARY_ELEMENTS.md, section 9).
namespace fringe::detail {

/// The charges of all unknowns for every conductor (columns) at unit potential.
struct SpaceSolution {
  bool positive_definite = true;  ///< if not, nothing else is set
  Eigen::MatrixXd charges;
  Eigen::MatrixXd residuals;          ///< of the potentials
  Eigen::MatrixXd matrix;             ///< the conductors' net charges
  Eigen::VectorXd missing;            ///< energies that the iteration may have left, for each column
  Eigen::VectorXd missing_of_change;  ///< the same of what the targets change; empty without a background
  int iterations = 0;                 ///< steps of the conjugate gradients

  Eigen::MatrixXd iteration_error() const;
  Eigen::MatrixXd iteration_error_of_change() const;
};

/// Solves by preconditioned conjugate gradients, all columns beside each other. `net` are the unknowns' net
/// charges for each conductor, `accuracy` the part of its energy that a column's last step may gain, `start`
/// charges of any accuracy.
SpaceSolution solve_space(const BorderedMatrix& matrix, const TwoLevelPreconditioner& preconditioner,
                          const Eigen::MatrixXd& net, const Eigen::VectorXd& accuracy, Eigen::MatrixXd start);

/// Solves for what the targets add to the charges of a background without them, of which no difference is
/// taken: the charges whose potentials cancel those of the background on the targets. `accuracy` is relative
/// to the energy of the change, `start` are changes of any accuracy. `is_machine` is one for unknowns of the
/// background, zero for those of the targets.
SpaceSolution solve_with_targets(const BorderedMatrix& matrix, const TwoLevelPreconditioner& preconditioner,
                                 const Eigen::MatrixXd& net, const Eigen::VectorXd& accuracy,
                                 Eigen::MatrixXd start, const SpaceSolution& background,
                                 const Eigen::VectorXd& is_machine);

}  // namespace fringe::detail
