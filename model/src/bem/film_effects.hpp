#pragma once

#include <cstddef>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "bem/insulated_equations.hpp"

namespace fringe::detail {

/// An undivided panel of a film, by the first of its quarters, and its side along which the potential bends
/// most.
struct BentPanel {
  std::size_t panel;
  std::size_t side;
};

/// Corrections of the energies that films as sheets have, over 4πε, between all columns of charges.
struct FilmEffects {
  Eigen::MatrixXd group_energies;  ///< of the potential along films beyond that of undivided panels, of the
                                   ///< columns in the groups (rows)
  std::vector<BentPanel> bent;
  Eigen::MatrixXd energies;  ///< the same between all columns, in all groups
  Eigen::MatrixXd across;    ///< what the thickness of the films adds
  Eigen::MatrixXd crowding;  ///< what it takes away beside the borders of conductors
};

/// Computes the corrections for charges of all unknowns (rows), with conductors at unit potential (columns).
FilmEffects film_effects(const PanelMesh& mesh, const InsulatedBodies& bodies,
                         const Surroundings& surroundings, const InsulatedEquations& equations,
                         const DoubleLayer& double_layer, const Eigen::MatrixXd& charges);

}  // namespace fringe::detail
