#pragma once

#include <functional>
#include <span>

#include <Eigen/Core>

#include "bem/panel_mesh.hpp"
#include "numeric/cholesky.hpp"
#include "surface/bodies.hpp"

/// The solution for a single body of triangles (model/BOUNDARY_ELEMENTS.md, sections 8 and 9).
namespace fringe::detail {

/// The body's panels, their single-layer matrix (the upper triangle) and its Cholesky factor.
struct SingleBodySystem {
  PanelMesh mesh;
  Eigen::MatrixXd matrix;
  Cholesky factor;
  double tolerance;  ///< of the quadratures for the matrix elements
  double ridge = 0;  ///< part that the diagonal has in excess, to make matrices of coincident panels regular
};

/// Returns the panels of surfaces that touch or overlap, as those of bodies 0, 1 and so on. What is hidden
/// inside another surface has none.
PanelMesh panels_of(std::span<const TriangleSurface> surfaces);

/// Returns potentials of degree 0 and 1 on panels (rows).
Eigen::MatrixXd plain_potentials(const PanelMesh& mesh);

/// Returns the energies of the responses to these, of which those to linear potentials count as at least a
/// part of the largest one. A flat body has almost no response across it, and what is missing of it does not
/// matter.
Eigen::VectorXd counted_energies(Eigen::VectorXd energies);

/// Returns the net charges on the first bodies (rows) of the panels' charges in all columns.
Eigen::MatrixXd net_charges(const PanelMesh& mesh, const Eigen::MatrixXd& charges, std::size_t bodies);

/// Refines the panels of a body of one or more surfaces until the energies of the charges that potentials of
/// degree 0 and 1 induce have an error below `accuracy`, as far as `most_panels` panels allow.
/// @throws InputError if the quadratures cannot make the matrix positive definite.
SingleBodySystem solve_single_body(std::span<const TriangleSurface> surfaces, double accuracy,
                                   std::size_t most_panels);

/// Returns the energies that charges of one density on each group miss, plus those that unrefined elements
/// miss for lack of their quarters, plus those of the ridge: a symmetric matrix. `responses` are the panels'
/// charges (rows) for so many potentials (columns), `potentials` their means on the panels, and `at` returns
/// the potentials at a point.
Eigen::MatrixXd missing_energies(const SingleBodySystem& panels, const Eigen::MatrixXd& potentials,
                                 const Eigen::MatrixXd& responses,
                                 const std::function<Eigen::RowVectorXd(const Eigen::Vector3d&)>& at);

}  // namespace fringe::detail
