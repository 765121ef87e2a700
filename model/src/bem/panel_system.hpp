#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Core>

#include "bem/bodies.hpp"
#include "bem/galerkin_system.hpp"
#include "bem/panel_equations.hpp"
#include "bem/panel_mesh.hpp"

/// The Galerkin equations of bodies of faces and bodies of panels (model/BOUNDARY_ELEMENTS.md, section 9).
namespace fringe::detail {

/// What the panels' charges tell besides. Of the sensors without the objects there is nothing where a sensor
/// has panels.
struct PanelSolution : GalerkinSolution {
  Eigen::MatrixXd charges;         ///< of every panel (rows) for every conductor at a potential of one
  Eigen::VectorXd group_energies;  ///< that the groups' own densities hold more than one density would
  Eigen::MatrixXd unfinished;      ///< what the iteration may have left of `all`
};

class PanelSystem {
 public:
  explicit PanelSystem(const ChargedBodies& bodies, const PanelGrading& grading = {});

  std::size_t faces() const { return faces_.faces(); }
  const PanelMesh& mesh() const { return mesh_; }

  /// Refines marked groups of panels, by the charges of the last solution.
  void refine_groups(const std::vector<bool>& marked, const Eigen::MatrixXd& charges);

  /// Evaluates the matrices for so many functions on each face; those that are known are kept.
  void refine(const std::vector<FaceFunctions>& functions, double tolerance);

  /// The panels' charges are iterated until a step brings a capacitance less than this part of it.
  PanelSolution solve(double accuracy) const;

  /// The sensors without the objects, by the functions and panels that they have beside them.
  PanelSolution solve_sensors(double accuracy) const;

 private:
  PanelSystem(const ChargedBodies& bodies, PanelMesh mesh);
  Eigen::MatrixXd face_matrix(const PanelUnknowns& unknowns) const;
  Eigen::MatrixXd quadrature_effect(const PanelUnknowns& unknowns, const Eigen::MatrixXd& charges,
                                    const Eigen::MatrixXd& norms) const;
  /// Halves what is so large that it would not see another body before it.
  void divide_under_shadows(std::size_t most_panels);
  void refine_coupling(const std::vector<FaceFunctions>& functions, double tolerance);

  const ChargedBodies& bodies_;
  ChargedBodies bodies_of_faces_;
  GalerkinSystem faces_;
  PanelMesh mesh_;
  Eigen::MatrixXd panels_;    ///< panel_matrix of all panels
  Eigen::MatrixXd coupling_;  ///< of the faces' functions (rows), one face after the other, with the panels
  std::vector<FaceFunctions> coupled_functions_;
  bool is_refined_ = false;  ///< panels_ is of the mesh before its last refinement
  double panel_tolerance_;
  double coupling_tolerance_;
};

}  // namespace fringe::detail
