#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "bem/single_layer_panels.hpp"
#include "surface/panel.hpp"

/// The double-layer operator of panels with a constant dipole density (model/BOUNDARY_ELEMENTS.md, section
/// 13).
namespace fringe::detail {

/// Computes the mean over each target (rows) of the solid angle of each panel that is a source (columns; zero
/// elsewhere), over 4π, positive where the source's normal points away from the target. Targets may be parts
/// of the panels. The jump across a source counts with the mean of both sides. `tolerance` is the absolute
/// error aimed at; known elements are for targets that are the panels. Threads: 0 means as many as this
/// process may run at once.
Eigen::MatrixXd double_layer_matrix(std::span<const Panel> targets, std::span<const Panel> panels,
                                    const std::vector<bool>& is_source, double tolerance,
                                    const KnownElements& known, std::size_t threads);

}  // namespace fringe::detail
