#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include <Eigen/Core>

#include "bem/galerkin_system.hpp"
#include "bem/jacobi_basis.hpp"
#include "bem/panel_equations.hpp"
#include "bem/panel_mesh.hpp"
#include "bem/panel_operator.hpp"
#include "bem/space_solution.hpp"
#include "surface/bodies.hpp"

/// The Galerkin equations of bodies some of which have faces and some panels (model/BOUNDARY_ELEMENTS.md,
/// section 9).
namespace fringe::detail {

/// Finest relative tolerance of the quadratures. Below it, rounding errors dominate the matrix elements.
constexpr double finest_tolerance = 1e-13;

/// The capacitances with the panels' charges and error indicators. `sensors` is empty if a sensor has
/// panels.
struct PanelSolution : GalerkinSolution {
  Eigen::MatrixXd charges;           ///< of every panel (rows) for every conductor at unit potential
  Eigen::MatrixXd coarse_charges;    ///< the same with one density on each group
  Eigen::MatrixXd reading_charges;   ///< of every panel (rows) in the columns of ReadingCharges::all()
  Eigen::VectorXd error_indicators;  ///< error indicators of the groups of panels
  Eigen::MatrixXd iteration_error;   ///< error of `all` that the conjugate gradients may have left
  Eigen::MatrixXd background_iteration_error;  ///< the same of `background`
  Eigen::MatrixXd change_iteration_error;      ///< the same of their difference, which is found by itself
  Eigen::MatrixXd ridge_effect;  ///< what a ridge may have taken, for each conductor that is not floating
  Eigen::MatrixXd reading_ridge_effect;  ///< between the columns of ReadingCharges::all()
};

/// The Galerkin equations of faces and panels. They are solved by conjugate gradients, or by Cholesky
/// factorisation if there are no panels.
class PanelSystem {
 public:
  explicit PanelSystem(const ChargedBodies& bodies, const PanelGrading& grading = {},
                       std::size_t threads = 1);

  std::size_t faces() const { return faces_.faces(); }
  /// Returns a face of the bodies that have faces, in their order, and the number of its functions.
  const ChargedFace& face(std::size_t face) const { return faces_.face(face); }
  FaceFunctions functions(std::size_t face) const { return faces_.functions(face); }
  const PanelMesh& mesh() const { return mesh_; }
  /// Returns the matrix of the panels as of the last refine().
  const PanelOperator& panel_operator() const { return *panels_; }

  /// Refines groups of panels in so many steps, by the charges of the last solution.
  void refine_groups(const std::vector<int>& steps, const Eigen::MatrixXd& charges);

  /// Evaluates the single-layer blocks for so many functions on each face; keeps those that are known.
  void refine(const std::vector<FaceFunctions>& functions, double tolerance);

  /// Solves by conjugate gradients, which stop when a step changes a capacitance, or what the targets change
  /// in it if there are readings, by less than `accuracy` times its value; without the targets, by
  /// `change_part` times as much: their answer to what is missing there has to be as small. Panels that
  /// coincide or nearly do make the matrix indefinite by errors of its elements: then its diagonal is raised
  /// by a ridge, by a part of `most_ridge` at most, and by less where that is enough. Such panels share their
  /// charge then.
  PanelSolution solve(double accuracy, double most_ridge = 0, double change_part = 1);

  /// Solves for the sensors without the other conductors, with the same functions and panels as with them.
  PanelSolution solve_sensors(double accuracy) const;

 private:
  PanelSystem(const ChargedBodies& bodies, PanelMesh mesh, std::size_t threads);
  PanelSolution solve_once(double accuracy, double change_part);
  void set_ridge(double ridge);
  Eigen::MatrixXd ridge_effect(const Eigen::MatrixXd& charges) const;
  /// The solution of the equations, or of those without the targets.
  struct Solved {
    SpaceSolution fine;
    SpaceSolution coarse;
    Eigen::MatrixXd charges;         ///< of all unknowns, in the order of the mesh
    Eigen::MatrixXd coarse_charges;  ///< of all panels, with one density on each group
    /// Without the targets: one for the unknowns that are there, zero for those of the targets.
    Eigen::VectorXd is_machine;
    Eigen::VectorXd is_machine_in_coarse;

    bool positive_definite() const { return fine.positive_definite && coarse.positive_definite; }
  };
  struct Spaces;
  Spaces spaces() const;
  Solved solve_equations(const PanelEquations& equations, const Spaces& spaces, double accuracy,
                         const Eigen::MatrixXd& begun, const Solved* background) const;
  Solved solve_without_targets(const PanelEquations& equations, const Spaces& spaces, double accuracy) const;
  Eigen::MatrixXd begun(const Eigen::MatrixXd& last, Eigen::Index functions) const;
  std::vector<Eigen::MatrixXd> charges_of_faces(const PanelUnknowns& unknowns,
                                                const Eigen::MatrixXd& charges) const;
  Eigen::MatrixXd face_matrix(const PanelUnknowns& unknowns) const;
  Eigen::MatrixXd body_charges(const PanelUnknowns& unknowns, const Eigen::MatrixXd& charges) const;
  Eigen::MatrixXd quadrature_effect(const PanelUnknowns& unknowns, const Eigen::MatrixXd& charges) const;
  void refine_coupling(const std::vector<FaceFunctions>& functions, double tolerance);

  const ChargedBodies& bodies_;
  std::size_t threads_;
  ChargedBodies bodies_of_faces_;
  GalerkinSystem faces_;
  PanelMesh mesh_;
  std::unique_ptr<PanelOperator> panels_;
  Eigen::MatrixXf coupling_;  ///< of the faces' functions (rows), face after face, with the panels
  std::vector<FaceFunctions> coupled_functions_;
  /// The charges of all unknowns with the last solution, as far as they go over to the refined mesh, by which
  /// the next iteration begins; none before the first solution.
  Eigen::MatrixXd last_charges_;
  Eigen::MatrixXd last_background_;
  std::vector<FaceFunctions> last_functions_;
  bool is_refined_ = false;  ///< true if panels_ belongs to the mesh before its last refinement
  double ridge_ = 0;         ///< part that the panels' diagonal has in excess
  double panel_tolerance_;
  double coupling_tolerance_;
};

}  // namespace fringe::detail
