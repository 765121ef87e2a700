#pragma once

#include <Eigen/Core>

#include "bem/panel_equations.hpp"

/// Error indicators: the energy that the charges of faces and panels miss. `charges` have one column for
/// every right-hand side, such as a conductor at unit potential; `own` are the energies of these solutions.
namespace fringe::detail {

/// Returns for every group of panels the energy that its panels' own densities add to that of one density. It
/// is relative to the energy of each solution, and the largest of these. `panels` is panel_matrix, `shares`
/// is area_shares, and `charges` are the panels'.
Eigen::VectorXd group_energies(const PanelMesh& mesh, const Eigen::MatrixXd& panels,
                               const Eigen::VectorXd& shares, const Eigen::MatrixXd& charges,
                               const Eigen::VectorXd& own);

/// The energy that unrefined elements, panels that were never divided, would gain from division. `charges`
/// are those of all unknowns.
struct UnseenEnergy {
  Eigen::MatrixXd gained;  ///< by every pair of conductors, summed over all panels; empty if there are no
                           ///< unrefined elements
  Eigen::VectorXd groups;  ///< by every group, as in group_energies()
};
UnseenEnergy unseen_energy(const PanelEquations& equations, const Eigen::MatrixXd& charges,
                           const Eigen::VectorXd& own, double tolerance);

}  // namespace fringe::detail
