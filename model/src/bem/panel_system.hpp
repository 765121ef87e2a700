#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <vector>

#include <Eigen/Core>

#include "bem/error_indicators.hpp"
#include "bem/face_blocks.hpp"
#include "bem/jacobi_basis.hpp"
#include "bem/panel_mesh.hpp"
#include "bem/panel_operator.hpp"
#include "bem/space_solution.hpp"
#include "readings/maxwell_matrix.hpp"
#include "surface/bodies.hpp"

/// The Galerkin equations of bodies some of which have faces and some panels (model/BOUNDARY_ELEMENTS.md,
/// section 9).
namespace fringe::detail {

/// Ratio of rtol to the first tolerance of the quadratures. Functions that resolve everything leave errors
/// far below rtol, and the quadrature errors must be well below those to give a lower bound.
constexpr double first_tolerance_part = 50;

/// The sensors without the other conductors.
struct SensorsAlone {
  bool positive_definite = true;      ///< false if the quadratures are too coarse; then nothing else is set
  NestedMatrix matrix;                ///< of all conductors; zero in rows that are not a sensor's
  Eigen::MatrixXd quadrature_effect;  ///< as in PanelSolution
  Eigen::MatrixXd iteration_error;    ///< as in PanelSolution
};

/// The unknowns of faces and panels: the functions of all faces, one face after the other, then the panels.
struct PanelUnknowns {
  std::vector<Eigen::Index> first;  ///< for each face
  Eigen::Index functions = 0;
  std::vector<Eigen::Index> coarse;  ///< functions of the faces in the coarse space
  Eigen::MatrixXd net;               ///< net charges, one column for every conductor
  /// Zero for the unknowns of bodies that are left out, else one; empty: ones.
  Eigen::VectorXd present;
};

/// The capacitances of a system with its charges and error indicators.
struct PanelSolution {
  bool positive_definite = true;  ///< false if the quadratures are too coarse; then nothing else is set
  NestedMatrix all;               ///< of all conductors
  SensorsAlone sensors;           ///< empty if a sensor has panels
  /// The same without the targets; rows of conductors that consist of targets are zero.
  NestedMatrix background;
  /// The charge on each body (rows) for every conductor at unit potential.
  Eigen::MatrixXd body_charges;
  /// Possible change of `all` for a unit error of the single-layer blocks of different bodies, relative to
  /// their largest elements.
  Eigen::MatrixXd quadrature_effect;
  /// The same between the columns of ReadingCharges::all().
  Eigen::MatrixXd reading_quadrature_effect;
  /// The energies of the charges beyond the coarse space, all counted as positive, between the same columns.
  Eigen::MatrixXd reading_details;
  /// The charges of every face's functions (rows) in the columns of ReadingCharges::all().
  std::vector<Eigen::MatrixXd> face_reading_charges;
  /// For every face and direction, the energy in its highest functions, relative to that of the conductors.
  std::vector<Eigen::Vector2d> highest;
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
/// factorisation where there are no panels.
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

  /// Evaluates the blocks and solves, with finer quadratures if the matrix is not positive definite;
  /// `tolerance` becomes theirs.
  /// @throws std::runtime_error if the finest quadratures do not help.
  PanelSolution solve_definite(const std::vector<FaceFunctions>& functions, double& tolerance,
                               double accuracy, double most_ridge = 0, double change_part = 1);

  /// Solves for the sensors without the other conductors, with the same functions and panels as with them.
  /// @throws std::runtime_error if the matrix is not positive definite.
  SensorsAlone solve_sensors(double accuracy) const;

 private:
  PanelSolution solve_once(double accuracy, double change_part);
  void set_ridge(double ridge);
  Eigen::MatrixXd ridge_effect(const Eigen::MatrixXd& charges) const;
  /// The solution of the equations, or of those without the targets.
  struct Solved {
    SpaceSolution fine;
    SpaceSolution coarse;
    Eigen::MatrixXd charges;         ///< of all unknowns, in the order of the mesh
    Eigen::MatrixXd coarse_charges;  ///< of all panels, with one density on each group
    /// One for the unknowns that are there, zero for the others; empty: ones.
    Eigen::VectorXd present;
    Eigen::VectorXd present_in_coarse;

    bool positive_definite() const { return fine.positive_definite && coarse.positive_definite; }
  };
  /// The matrix of the faces and the spaces of fewer functions, with their matrices. The equations with and
  /// without the targets share them.
  struct Spaces {
    Eigen::MatrixXd functions;  ///< the matrix of the faces' functions; none without panels
    Restriction to_groups;
    HierarchicalMatrix groups;  ///< the matrix of one density on each group
    CoarseSpace of_panels;
    CoarseSpace of_groups;
  };
  Spaces spaces() const;
  SensorsAlone solve_sensors(const Spaces& spaces, double accuracy) const;
  PanelUnknowns number_unknowns() const;
  PanelUnknowns unknowns_of(PanelUnknowns unknowns,
                            const std::function<bool(const ChargedBody&)>& is_there) const;
  Solved solve_functions(const PanelUnknowns& unknowns, Eigen::Index groups) const;
  Solved solve_equations(const PanelUnknowns& unknowns, const Spaces& spaces, double accuracy,
                         const Eigen::MatrixXd& begun, const Solved* background) const;
  Eigen::MatrixXd gained_by_division(const SampledQuarters& sampled, const PanelUnknowns& unknowns,
                                     const Eigen::MatrixXd& charges, const Eigen::MatrixXd& of_present) const;
  Eigen::MatrixXd begun(const Eigen::MatrixXd& last, Eigen::Index functions) const;
  std::vector<Eigen::MatrixXd> charges_of_faces(const PanelUnknowns& unknowns,
                                                const Eigen::MatrixXd& charges) const;
  Eigen::MatrixXd face_matrix(const PanelUnknowns& unknowns, const std::vector<Eigen::Index>& order) const;
  Eigen::MatrixXd body_charges(const PanelUnknowns& unknowns, const Eigen::MatrixXd& charges) const;
  Eigen::MatrixXd quadrature_effect(const PanelUnknowns& unknowns, const Eigen::MatrixXd& charges) const;
  void refine_coupling(const std::vector<FaceFunctions>& functions, double tolerance);

  const ChargedBodies& bodies_;
  std::size_t threads_;
  FaceBlocks faces_;
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
