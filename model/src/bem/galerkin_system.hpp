#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

#include "bem/jacobi_basis.hpp"
#include "readings/maxwell_matrix.hpp"
#include "surface/bodies.hpp"
#include "surface/face.hpp"

/// The Galerkin equations of charged bodies (model/BOUNDARY_ELEMENTS.md, section 1). Capacitances are in
/// metres: to be multiplied by 4πε.
namespace fringe::detail {

/// The capacitances of a system and their error indicators.
struct GalerkinSolution {
  bool positive_definite = true;  ///< false if the quadratures are too coarse; then nothing else is set
  NestedMatrix all;               ///< of all conductors
  NestedMatrix sensors;           ///< of the sensors, in the first rows, without the other conductors
  /// Of all conductors without the targets; rows of conductors that consist of targets are zero.
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
};

/// The charges of every face's functions (rows), and what their energies are relative to.
struct FaceCharges {
  std::vector<Eigen::MatrixXd> conductors;  ///< for every conductor at unit potential
  std::vector<Eigen::MatrixXd> readings;    ///< the columns of ReadingCharges::all(); empty if there are none
  Eigen::VectorXd own;                      ///< the conductors' own capacitances
  Eigen::VectorXd change_scales;            ///< of the readings' changes; empty if these are not asked for
};

/// Returns the norms of every face's coefficients (rows) in every column.
Eigen::MatrixXd norms_of_faces(const std::vector<Eigen::MatrixXd>& charges);

/// Returns the number of functions of the coarse space along a direction; `functions` must be odd, 3 or more.
int coarse_functions(int functions);

/// Returns true if a face's function belongs to the coarse space.
bool is_coarse(FaceFunctions functions, int function);

/// The Galerkin equations of bodies with faces. The single-layer blocks are kept from one refinement to the
/// next; the equations are solved by Cholesky factorisation.
class GalerkinSystem {
 public:
  explicit GalerkinSystem(const ChargedBodies& bodies);

  std::size_t faces() const { return faces_.size(); }

  /// Evaluates the single-layer blocks for so many functions on each face; keeps those that are known.
  void refine(const std::vector<FaceFunctions>& functions, double tolerance);

  GalerkinSolution solve() const;

  /// The sensors without the other conductors.
  struct Alone {
    bool positive_definite;  ///< false if the quadratures are too coarse; then nothing else is set
    NestedMatrix matrix;     ///< of all conductors; zero in rows that are not a sensor's
  };
  Alone solve_sensors() const;

  const ChargedFace& face(std::size_t face) const { return faces_[face]; }
  FaceFunctions functions(std::size_t face) const { return functions_[face]; }
  bool is_target(std::size_t face) const { return bodies_.bodies[body_of_[face]].is_target; }
  std::size_t conductor(std::size_t face) const { return bodies_.bodies[body_of_[face]].conductor; }
  /// Returns the net charge of a face's first function, the only one that has any.
  double net_charge(std::size_t face) const;
  /// Returns the single-layer block of two faces a ≤ b.
  const Eigen::MatrixXd& block(std::size_t a, std::size_t b) const { return blocks_[pair(a, b)].values; }

  /// Returns the energies in the highest functions, as in GalerkinSolution.
  std::vector<Eigen::Vector2d> highest_energies(const FaceCharges& charges) const;

  /// Returns the energies of the charges beyond the coarse space, all counted as positive, between the
  /// columns of every face's coefficients.
  Eigen::MatrixXd detail_energies(const std::vector<Eigen::MatrixXd>& charges) const;

  /// Returns the possible change of the capacitances for a unit error of the single-layer blocks of different
  /// bodies, relative to their largest elements. `norms` are those of each face's coefficients (rows) in
  /// every column.
  Eigen::MatrixXd quadrature_effect(const Eigen::MatrixXd& norms) const;

 private:
  struct Block {
    FaceFunctions first{0, 0};
    FaceFunctions second{0, 0};
    double tolerance = 1;
    Eigen::MatrixXd values;
  };

  /// The solution for some conductors: the numbering of their faces' functions, and their charges.
  struct Solved;
  Solved solve(std::span<const std::size_t> faces, Eigen::Index conductors) const;
  std::vector<std::size_t> sensor_faces() const;
  std::vector<std::size_t> machine_faces() const;
  std::vector<Eigen::MatrixXd> charges_of_faces(const Solved& solved) const;
  std::size_t pair(std::size_t a, std::size_t b) const { return a * faces_.size() + b; }
  void refine_body(std::size_t body);
  void refine_pair(std::size_t a, std::size_t b, double tolerance);

  const ChargedBodies& bodies_;
  std::vector<ChargedFace> faces_;
  std::vector<std::size_t> body_of_;     ///< for each face
  std::vector<std::size_t> first_face_;  ///< for each body
  std::vector<FaceFunctions> functions_;
  std::vector<Block> blocks_;  ///< for faces a ≤ b, at pair(a, b)
};

}  // namespace fringe::detail
