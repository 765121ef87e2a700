#pragma once

#include <Eigen/Core>

#include "bem/error_indicators.hpp"
#include "bem/insulated_equations.hpp"

/// Energy that conductors and interfaces of dielectrics would gain if their undivided triangles were divided
/// (model/BOUNDARY_ELEMENTS.md, section 13).
namespace fringe::detail {

/// The quarters of a sample of the undivided triangles, with the solid angles (rows: quarters) of all panels
/// as means over them, over 4π.
struct QuartersWithAngles {
  SampledQuarters sampled;
  DoubleLayer double_layer;
};

/// Energies that the change from the coarse to the whole space does not show.
struct UndividedGain {
  /// Four rows for each sampled triangle, a column for each conductor at unit potential: products of columns
  /// add up to the energies between conductors.
  Eigen::MatrixXd roots;
  Eigen::MatrixXd groups;  ///< of the groups of panels (rows), for each conductor at unit potential
};

/// Estimates the energies from the potentials on the sampled quarters, for the solution `values` of the
/// equations. `tolerance` is that of the single-layer elements.
UndividedGain undivided_gain(const PanelMesh& mesh, const InsulatedBodies& bodies,
                             const InsulatedEquations& equations, const QuartersWithAngles& quarters,
                             const Eigen::MatrixXd& values, double tolerance);

}  // namespace fringe::detail
