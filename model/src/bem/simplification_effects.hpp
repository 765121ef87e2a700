#pragma once

#include <Eigen/Core>

#include "bem/panel_mesh.hpp"
#include "surface/simplification.hpp"

namespace fringe::detail {

/// Returns what surfaces that were replaced may change, for every panel, per squared charge on it; zero on
/// round shapes and on bodies that are not the simplification's.
Eigen::VectorXd deviation_effects(const Simplification& simplification, const PanelMesh& mesh);

/// Effects of simplified surfaces and of facets on the capacitances between columns of charges (m). They
/// follow from Hadamard's formula for a conductor whose surface moves by a small distance along its normal.
struct SurfaceEffects {
  Eigen::MatrixXd facets;          ///< of round shapes that panels follow, to be added
  Eigen::MatrixXd facet_errors;    ///< what that may be wrong by; it falls with refinement
  Eigen::MatrixXd lasting_errors;  ///< by simplified surfaces and other round shapes
};

/// `charges` has a row for every panel. Errors have the same sign everywhere.
SurfaceEffects surface_effects(const Simplification& simplification, const PanelMesh& mesh,
                               const Eigen::MatrixXd& charges);

}  // namespace fringe::detail
