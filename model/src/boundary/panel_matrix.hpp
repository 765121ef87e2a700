#pragma once

#include <span>

#include <Eigen/Core>

#include "panel.hpp"

namespace fringe::detail {

/// The interaction ∫∫1/r of all pairs of panels, their charges being one: the upper triangle of the matrix,
/// nothing below it. `tolerance` is the error aimed at of each element (model/BOUNDARY_ELEMENTS.md, section
/// 8).
Eigen::MatrixXd panel_matrix(std::span<const Panel> panels, double tolerance);

/// That of a panel with itself, in closed form.
double panel_self(const Panel& panel);

}  // namespace fringe::detail
