#pragma once

#include <span>

#include <Eigen/Core>

#include "bem/panel.hpp"

namespace fringe::detail {

/// Elements that are known: those of panels that stand in another matrix, at their places there. Where a
/// place is negative, or there are no places, nothing is known.
struct KnownElements {
  const Eigen::MatrixXd& matrix;
  std::span<const Eigen::Index> places;
};

/// The interaction ∫∫1/r of all pairs of panels, their charges being one: the upper triangle of the matrix,
/// nothing below it. `tolerance` is the error aimed at of each element (model/BOUNDARY_ELEMENTS.md, section
/// 9).
Eigen::MatrixXd panel_matrix(std::span<const Panel> panels, double tolerance, const KnownElements& known);
Eigen::MatrixXd panel_matrix(std::span<const Panel> panels, double tolerance);

/// The mean potentials on targets, which may be parts of panels, of charges on the panels; a column for each
/// column of charges.
Eigen::MatrixXd panel_potentials(std::span<const Panel> targets, std::span<const Panel> panels,
                                 const Eigen::MatrixXd& charges, double tolerance);

/// That of a panel with itself, in closed form.
double panel_self(const Panel& panel);

}  // namespace fringe::detail
