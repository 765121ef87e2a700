#pragma once

#include <Eigen/Core>

#include "bem/coarse_space.hpp"
#include "bem/panel_equations.hpp"

namespace fringe::detail {

/// The charges of all unknowns, a column for every conductor at a potential of one.
struct IteratedCharges {
  bool positive_definite = true;  ///< false when a step shows otherwise; then there is nothing else
  Eigen::MatrixXd charges;
  Eigen::MatrixXd residuals;
  Eigen::VectorXd gains;    ///< the energy that the last step brought to each
  Eigen::MatrixXd smaller;  ///< the smaller space's energies: the scalar products of the columns
};

/// Conjugate gradients from the nested space's answer, until a step brings a capacitance less than a part of
/// it.
IteratedCharges iterate(const PanelEquations& equations, const NestedSpace& nested, double accuracy);

}  // namespace fringe::detail
