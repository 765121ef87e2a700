#pragma once

#include <vector>

#include <Eigen/Core>

#include "bem/panel_mesh.hpp"

/// The coarse space of charges: one density on each group of panels (model/BOUNDARY_ELEMENTS.md, section 9).
namespace fringe::detail {

/// Estimated error of the energies, per change from this space to the panels' own densities. The error falls
/// more slowly than with functions: only like the first power of the number of panels along a direction where
/// singular edges are not resolved. Opposite a body close by it reached 1.6 times the change.
constexpr double error_per_panel_change = 2;

/// Returns the fraction of its group's area that each panel has: its charge if the group has one density and
/// unit charge.
Eigen::VectorXd area_shares(const PanelMesh& mesh);

/// Averages the panels' values (rows) over each group, weighted by area; returns a row for every group.
Eigen::MatrixXd group_means(const PanelMesh& mesh, const Eigen::VectorXd& shares,
                            const Eigen::Ref<const Eigen::MatrixXd>& values);

/// Computes the single-layer matrix of the groups, with one density and unit charge on each: the lower
/// triangle, nothing above it. `panels` is the panels' own, single_layer_matrix.
Eigen::MatrixXd group_matrix(const PanelMesh& mesh, const Eigen::VectorXd& shares,
                             const Eigen::MatrixXd& panels);

/// Returns for each group the block of its panels with each other, from single_layer_matrix of all panels.
std::vector<Eigen::MatrixXd> group_blocks(const PanelMesh& mesh, const Eigen::MatrixXd& panels);

}  // namespace fringe::detail
