#pragma once

#include <Eigen/Core>

#include "bem/coarse_space.hpp"
#include "bem/panel_equations.hpp"

namespace fringe::detail {

/// The charges of all unknowns, with one column for every conductor at unit potential.
struct IteratedCharges {
  bool positive_definite = true;  ///< false if a step shows otherwise; then nothing else is set
  Eigen::MatrixXd charges;
  Eigen::MatrixXd residuals;
  Eigen::VectorXd gains;    ///< the energy-norm decrement of the last step, for each column
  Eigen::MatrixXd smaller;  ///< columns whose scalar products are the energies in the coarse space
};

/// Solves for the charges by preconditioned conjugate gradients. Starts from the coarse solve and stops when
/// a step changes a capacitance by less than `accuracy` times its value.
IteratedCharges iterate(const PanelEquations& equations, const NestedSpace& nested, double accuracy);

}  // namespace fringe::detail
