#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

#include "bem/insulated_equations.hpp"

namespace fringe::detail {

/// Returns for each panel its place among the unknowns; -1 where it has none.
std::vector<Eigen::Index> places_of_panels(const PanelMesh& mesh, const InsulatedUnknowns& unknowns);

/// Returns the potentials of all unknowns' panels (rows): those of interfaces are among the values, those of
/// conductors are given; zero on films.
Eigen::MatrixXd potentials_of_panels(const InsulatedBodies& bodies, const InsulatedUnknowns& unknowns,
                                     const Eigen::MatrixXd& values);

/// Returns the mean potentials of a solution on other triangles (rows), by the right side of the equations.
/// @param double_layer means over the targets (rows) of the solid angles of all panels, over 4π
/// @param places for each target its permittivity, and on which surface it lies
/// @param values the unknowns, a column for each conductor at unit potential
Eigen::MatrixXd potentials_beside(const PanelMesh& mesh, const InsulatedBodies& bodies,
                                  const InsulatedEquations& equations, std::span<const Panel> targets,
                                  const DoubleLayer& double_layer, const std::vector<AngleTarget>& places,
                                  const Eigen::MatrixXd& values, double tolerance);

}  // namespace fringe::detail
