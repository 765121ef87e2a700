#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "bem/double_layer.hpp"
#include "bem/film_sheets.hpp"
#include "bem/insulated_matrix.hpp"
#include "bem/panel_mesh.hpp"
#include "bem/solid_angle_sums.hpp"
#include "surface/insulators.hpp"

/// The equations of conductors, dielectric bodies and films on panels (model/BOUNDARY_ELEMENTS.md, section
/// 13).
namespace fringe::detail {

/// Energy of a potential that changes by one over a part of size one, over 4π.
constexpr double energy_of_potential_step = 0.25;

/// The equations of a set of bodies: every row is the mean over a panel of
/// ε(x)·u(x) = Σ V q + Σ (ε behind − ε before)·u·(solid angle/4π).
struct InsulatedEquations {
  InsulatedUnknowns unknowns;
  InsulatedMatrix matrix;
  Eigen::MatrixXd potentials;            ///< right sides, one column for every conductor at unit potential
  std::vector<Eigen::Index> components;  ///< of each unknown, as from components_of()
  std::optional<FilmSheets> films;
  std::vector<Eigen::Index> film_unknowns;  ///< places of the films' panels among the unknowns
  std::size_t threads = 1;                  ///< how many compute with them; 0: all

  /// Returns an unknown's panel as a target of solid angles.
  AngleTarget target(Eigen::Index k) const;
};

/// Returns the equations of the bodies that are there.
/// @param single_layer of all panels of the mesh; has to live as long as the equations
/// @param double_layer means over panels (rows) of solid angles over 4π
InsulatedEquations insulated_equations(const PanelMesh& mesh, const InsulatedBodies& bodies,
                                       const Surroundings& surroundings, const PanelOperator& single_layer,
                                       const DoubleLayer& double_layer, std::size_t threads);

}  // namespace fringe::detail
