#pragma once

#include <Eigen/Core>

#include "bem/panel_equations.hpp"

/// What the charges of faces and panels tell of the energy that is missing. `charges` have a column for every
/// case, as a conductor at a potential of one, `own` the cases' energies.
namespace fringe::detail {

/// For every group of panels, what their own densities hold more than one density would, relative to the
/// cases' energies, the largest of them. `panels` is panel_matrix, `shares` area_shares, and `charges` are
/// the panels'.
Eigen::VectorXd group_energies(const PanelMesh& mesh, const Eigen::MatrixXd& panels,
                               const Eigen::VectorXd& shares, const Eigen::MatrixXd& charges,
                               const Eigen::VectorXd& own);

/// What the panels that were never divided would gain if they were. `charges` are those of all unknowns.
struct UnseenEnergy {
  Eigen::MatrixXd gained;  ///< by every pair of conductors, all panels together; empty if none is undivided
  Eigen::VectorXd groups;  ///< by every group, as group_energies() has them
};
UnseenEnergy unseen_energy(const PanelEquations& equations, const Eigen::MatrixXd& charges,
                           const Eigen::VectorXd& own, double tolerance);

}  // namespace fringe::detail
