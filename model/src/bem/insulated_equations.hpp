#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "bem/film_sheets.hpp"
#include "bem/panel_mesh.hpp"
#include "bem/solid_angle_sums.hpp"
#include "surface/insulators.hpp"

/// The equations of conductors, dielectric bodies and films on panels, and their solution
/// (model/BOUNDARY_ELEMENTS.md, section 13).
namespace fringe::detail {

/// Energy of a potential that changes by one over a part of size one, over 4π.
constexpr double energy_of_potential_step = 0.25;

/// The unknowns of a set of bodies: one for each panel that is there, and for the coarse space one for those
/// of a group that are alike.
struct InsulatedUnknowns {
  std::vector<Eigen::Index> panels;  ///< of each unknown
  std::vector<PartState> states;     ///< of each unknown
  std::vector<Eigen::Index> coarse;  ///< of each unknown, its place in the coarse space
  std::vector<Eigen::Index> body;    ///< of each unknown
  Eigen::VectorXd shares;  ///< of each unknown, its part of the area of its place in the coarse space
  Eigen::Index coarse_size = 0;

  Eigen::Index size() const { return index_of(panels.size()); }
  PartKind kind(Eigen::Index k) const { return states[static_cast<std::size_t>(k)].kind; }
  /// Tells if the unknown is a charge; else it is the potential of an interface.
  bool is_charge(Eigen::Index k) const { return kind(k) != PartKind::interface; }
};

/// The equations of a set of bodies: every row is the mean over a panel of
/// ε(x)·u(x) = Σ V q + Σ (ε behind − ε before)·u·(solid angle/4π).
struct InsulatedEquations {
  InsulatedUnknowns unknowns;
  Eigen::MatrixXd matrix;
  Eigen::MatrixXd potentials;            ///< right sides, one column for every conductor at unit potential
  std::vector<Eigen::Index> components;  ///< of each unknown, as from components_of()
  std::optional<FilmSheets> films;
  std::vector<Eigen::Index> film_unknowns;  ///< places of the films' panels among the unknowns
  std::size_t threads = 1;                  ///< how many compute with them; 0: all

  /// Returns an unknown's panel as a target of solid angles.
  AngleTarget target(Eigen::Index k) const;
};

/// Returns the equations of the bodies that are there.
/// @param single_layer means over panels (rows) of the potentials of unit charges
/// @param double_layer means over panels (rows) of solid angles over 4π
InsulatedEquations insulated_equations(const PanelMesh& mesh, const InsulatedBodies& bodies,
                                       const Surroundings& surroundings, const Eigen::MatrixXd& single_layer,
                                       const Eigen::MatrixXd& double_layer, std::size_t threads);

/// Solutions in the whole space and in the coarse one (rows: the unknowns), and what the coarse space misses.
struct InsulatedSolutions {
  Eigen::MatrixXd fine;
  Eigen::MatrixXd coarse;
  Eigen::MatrixXd details;
};

/// Solves for right sides (columns): by factorisation if there are few unknowns, else iteratively. The same
/// bits for any number of threads.
InsulatedSolutions solved(const PanelMesh& mesh, const InsulatedEquations& equations,
                          const Eigen::MatrixXd& right_sides, std::size_t threads);

}  // namespace fringe::detail
