#pragma once

#include <span>

#include <Eigen/Core>

#include "bem/face.hpp"
#include "bem/panel.hpp"

namespace fringe::detail {

/// Elements that are known from another matrix: those between panels that have a place there. A negative
/// place, or no places, means that nothing is known.
struct KnownElements {
  const Eigen::MatrixXd& matrix;
  std::span<const Eigen::Index> places;
};

/// Computes the single-layer matrix ∫∫1/r of all pairs of panels with unit charges: its upper triangle,
/// nothing below it. `tolerance` is the error aimed at for each element (model/BOUNDARY_ELEMENTS.md, section
/// 9).
Eigen::MatrixXd single_layer_matrix(std::span<const Panel> panels, double tolerance,
                                    const KnownElements& known);
Eigen::MatrixXd single_layer_matrix(std::span<const Panel> panels, double tolerance);

/// Computes the mean potentials on targets, which may be parts of panels, of charges on the panels; one
/// column for each column of charges.
Eigen::MatrixXd panel_potentials(std::span<const Panel> targets, std::span<const Panel> panels,
                                 const Eigen::MatrixXd& charges, double tolerance);

/// Returns the interaction of a panel with itself, in closed form.
double panel_self(const Panel& panel);

/// Computes the single-layer block of a face's functions (rows) with panels of unit charge (columns) that do
/// not touch it. `tolerance` is the error aimed at, relative to the largest elements of a column.
Eigen::MatrixXd single_layer_block(const ChargedFace& face, FaceFunctions functions,
                                   std::span<const Panel> panels, double tolerance);

}  // namespace fringe::detail
