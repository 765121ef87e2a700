#pragma once

#include <span>

#include <Eigen/Core>

#include "bem/face.hpp"
#include "bem/panel.hpp"

namespace fringe::detail {

/// Computes the single-layer block of a face's functions (rows) with panels of unit charge (columns) that do
/// not touch it. `tolerance` is the error aimed at, relative to the largest elements of a column.
Eigen::MatrixXd panel_coupling(const ChargedFace& face, FaceFunctions functions,
                               std::span<const Panel> panels, double tolerance);

}  // namespace fringe::detail
