#pragma once

#include <Eigen/Core>

#include "bem/panel_mesh.hpp"

/// The smaller space of charges: one density on each group of panels (model/BOUNDARY_ELEMENTS.md, section 9).
namespace fringe::detail {

/// The error by what panels of their own change in the energies of this space. It falls more slowly than with
/// functions: singular edges leave the first power of the panels' number along a direction where they are not
/// resolved, and the shadow of a body close by as much as 1.6 times the change.
constexpr double error_per_panel_change = 2;

/// Of each panel in its group's area: the charges of one density on each group.
Eigen::VectorXd area_shares(const PanelMesh& mesh);

/// What every group makes of its panels' values (rows), a row for each: their mean by area.
Eigen::MatrixXd group_means(const PanelMesh& mesh, const Eigen::VectorXd& shares,
                            const Eigen::Ref<const Eigen::MatrixXd>& values);

/// The interaction of all pairs of groups, their charges being one: the lower triangle, nothing above it.
/// `panels` is the panels' own, panel_matrix.
Eigen::MatrixXd group_matrix(const PanelMesh& mesh, const Eigen::VectorXd& shares,
                             const Eigen::MatrixXd& panels);

/// That of a group's panels with each other, whole.
Eigen::MatrixXd matrix_of_group(const PanelGroup& group, const Eigen::MatrixXd& panels);

}  // namespace fringe::detail
