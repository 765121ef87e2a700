#pragma once

#include <Eigen/Core>

#include "panel_equations.hpp"

/// What the charges of faces and panels tell of the energy that is missing. `charges` are those of all
/// unknowns, a column for every conductor at a potential of one, `own` the conductors' own capacitances.
namespace fringe::detail {

/// For every group of panels, what their own densities hold more than one density would, relative to the
/// conductors' energies. `shares` are the panels' parts of their groups' areas.
Eigen::VectorXd group_energies(const PanelEquations& equations, const Eigen::VectorXd& shares,
                               const Eigen::MatrixXd& charges, const Eigen::VectorXd& own);

/// What the panels that were never divided would gain if they were.
struct UnseenEnergy {
  Eigen::MatrixXd gained;  ///< by every pair of conductors, all panels together; empty if none is undivided
  Eigen::VectorXd groups;  ///< by every group, as group_energies() has them
};
UnseenEnergy unseen_energy(const PanelEquations& equations, const Eigen::MatrixXd& charges,
                           const Eigen::VectorXd& own, double tolerance);

}  // namespace fringe::detail
