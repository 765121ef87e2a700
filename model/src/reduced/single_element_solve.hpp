#pragma once

#include <functional>
#include <span>

#include <Eigen/Cholesky>
#include <Eigen/Core>

#include "bem/panel_mesh.hpp"

/// A body of triangles by itself (model/BOUNDARY_ELEMENTS.md, sections 8 and 9).
namespace fringe::detail {

/// Its panels, the matrix of their interactions (the upper triangle) and Cholesky's factor of it.
struct LonePanels {
  PanelMesh mesh;
  Eigen::MatrixXd matrix;
  Eigen::LLT<Eigen::MatrixXd> factor;
  double tolerance;  ///< of the matrix's elements
};

/// Panels that are refined until the energies of the charges which potentials of degree 0 and 1 induce have
/// an error less than `accuracy`, as far as `most_panels` panels allow.
/// @throws InputError for triangles that lie upon each other.
LonePanels lone_panels(std::span<const Triangle> triangles, double accuracy, std::size_t most_panels);

/// What charges of one density on each group lack of energies, and undivided panels of those of their
/// quarters: a symmetric matrix. `responses` are the panels' charges (rows) for so many potentials (columns),
/// `potentials` their means on the panels, and `at` returns the potentials at a point.
Eigen::MatrixXd missing_energies(const LonePanels& panels, const Eigen::MatrixXd& potentials,
                                 const Eigen::MatrixXd& responses,
                                 const std::function<Eigen::RowVectorXd(const Eigen::Vector3d&)>& at);

}  // namespace fringe::detail
