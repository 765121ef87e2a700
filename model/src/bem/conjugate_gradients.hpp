#pragma once

#include <Eigen/Core>

#include "bem/bordered_matrix.hpp"
#include "bem/two_level_preconditioner.hpp"

namespace fringe::detail {

/// The charges of all unknowns, with one column for every right-hand side.
struct ConjugateGradientSolution {
  bool positive_definite = true;  ///< false if a step shows otherwise; then nothing else is set
  Eigen::MatrixXd charges;
  Eigen::MatrixXd residuals;
  Eigen::VectorXd decrements;  ///< the energy-norm decrement of the last step, for each column
  int iterations = 0;
};

/// Solves matrix·charges = right_sides by preconditioned conjugate gradients, all columns beside each other.
/// Begins with `start`, charges of any accuracy, and stops each column when a step changes its energy by less
/// than its part of `accuracy` of that energy, or of `least` where that is larger.
ConjugateGradientSolution conjugate_gradients(const BorderedMatrix& matrix,
                                              const TwoLevelPreconditioner& preconditioner,
                                              const Eigen::MatrixXd& right_sides,
                                              const Eigen::VectorXd& accuracy, const Eigen::VectorXd& least,
                                              Eigen::MatrixXd start);

}  // namespace fringe::detail
