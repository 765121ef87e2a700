#pragma once

#include <vector>

#include <Eigen/Core>

#include "bem/jacobi_basis.hpp"
#include "surface/bodies.hpp"
#include "surface/face.hpp"

/// The Galerkin matrix of faces (model/BOUNDARY_ELEMENTS.md, section 1). Capacitances are in metres: to be
/// multiplied by 4πε.
namespace fringe::detail {

/// The charges of every face's functions (rows), and what their energies are relative to.
struct FaceCharges {
  std::vector<Eigen::MatrixXd> conductors;  ///< for every conductor at unit potential
  std::vector<Eigen::MatrixXd> readings;    ///< the columns of ReadingCharges::all(); empty if there are none
  Eigen::VectorXd own;                      ///< the conductors' own capacitances
  Eigen::VectorXd change_scales;            ///< of the readings' changes; empty if these are not asked for
};

/// Returns the norms of every face's coefficients (rows) in every column.
Eigen::MatrixXd norms_of_faces(const std::vector<Eigen::MatrixXd>& charges);

/// The single-layer blocks of the faces of bodies, those of triangles left out. They are kept from one
/// refinement to the next.
class FaceBlocks {
 public:
  explicit FaceBlocks(const ChargedBodies& bodies);

  std::size_t faces() const { return faces_.size(); }

  /// Evaluates the single-layer blocks for so many functions on each face; keeps those that are known.
  void refine(const std::vector<FaceFunctions>& functions, double tolerance);

  const ChargedFace& face(std::size_t face) const { return faces_[face]; }
  FaceFunctions functions(std::size_t face) const { return functions_[face]; }
  /// Returns the number of a face's body.
  std::size_t body(std::size_t face) const { return body_of_[face]; }
  /// Returns the net charge of a face's first function, the only one that has any.
  double net_charge(std::size_t face) const;
  /// Returns the single-layer block of two faces a ≤ b.
  const Eigen::MatrixXd& block(std::size_t a, std::size_t b) const { return blocks_[pair(a, b)].values; }

  /// Returns for every face and direction the energy in its highest functions, relative to that of the
  /// conductors.
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
