#pragma once

#include <vector>

#include <Eigen/Core>

#include "bem/bodies.hpp"
#include "bem/face.hpp"

/// The Galerkin equations of charged bodies (model/BOUNDARY_ELEMENTS.md, section 1). Capacitances are in
/// metres: to be multiplied by 4πε.
namespace fringe::detail {

/// A matrix of conductors in the whole space of functions, and in one of about two thirds of them along each
/// direction.
struct NestedMatrix {
  Eigen::MatrixXd fine;
  Eigen::MatrixXd coarse;
};

/// What the charges of a system tell.
struct GalerkinSolution {
  bool positive_definite = true;  ///< false when the quadratures are too coarse; then there is nothing else
  NestedMatrix all;               ///< of all conductors
  NestedMatrix sensors;           ///< of the sensors without the objects
  /// How much an error of the mutual matrices, relative to their largest elements, may change `all`.
  Eigen::MatrixXd quadrature_effect;
  /// For every face and direction, the energy in its highest functions, relative to that of the conductors.
  std::vector<Eigen::Vector2d> highest;
};

/// What the charges on faces tell.
struct FaceEnergies {
  Eigen::MatrixXd norms;  ///< of each face's coefficients (rows) for every conductor at a potential of one
  std::vector<Eigen::Vector2d> highest;  ///< as GalerkinSolution has them
};

/// The functions of the smaller space along a direction with an odd number of functions, 3 or more.
int coarse_functions(int functions);

/// Whether a face's function is one of the smaller space.
bool is_coarse(FaceFunctions functions, int function);

class GalerkinSystem {
 public:
  explicit GalerkinSystem(const ChargedBodies& bodies);

  std::size_t faces() const { return faces_.size(); }

  /// Evaluates the matrices for so many functions on each face; those that are known are kept.
  void refine(const std::vector<FaceFunctions>& functions, double tolerance);

  GalerkinSolution solve() const;

  /// The matrix of the sensors without the objects; nothing of it if the quadratures are too coarse.
  NestedMatrix solve_sensors() const;

  const ChargedFace& face(std::size_t face) const { return faces_[face]; }
  FaceFunctions functions(std::size_t face) const { return functions_[face]; }
  std::size_t conductor(std::size_t face) const { return bodies_.bodies[body_of_[face]].conductor; }
  /// The net charge of a face's first function, the only one that has any.
  double net_charge(std::size_t face) const;
  /// The interaction of two faces a ≤ b.
  const Eigen::MatrixXd& block(std::size_t a, std::size_t b) const { return blocks_[pair(a, b)].values; }

  /// For every face its coefficients, a column for every conductor; `own` the conductors' own capacitances.
  FaceEnergies energies(const std::vector<Eigen::MatrixXd>& charges, const Eigen::VectorXd& own) const;

  /// How much the mutual matrices' errors, relative to their largest elements, may change the capacitances:
  /// by the norm of each face's coefficients (rows) for every conductor at a potential of one.
  Eigen::MatrixXd quadrature_effect(const Eigen::MatrixXd& norms) const;

 private:
  struct Block {
    FaceFunctions first{0, 0};
    FaceFunctions second{0, 0};
    double tolerance = 1;
    Eigen::MatrixXd values;
  };

  /// Of the first faces: the numbering of their functions, and the charges of the first conductors.
  struct Solved;
  Solved solve(std::size_t faces, Eigen::Index columns) const;
  std::size_t sensor_faces() const;
  std::size_t pair(std::size_t a, std::size_t b) const { return a * faces_.size() + b; }
  void refine_body(std::size_t body);
  void refine_pair(std::size_t a, std::size_t b, double tolerance);

  const ChargedBodies& bodies_;
  std::vector<ChargedFace> faces_;
  std::vector<std::size_t> body_of_;     ///< of each face
  std::vector<std::size_t> first_face_;  ///< of each body
  std::vector<FaceFunctions> functions_;
  std::vector<Block> blocks_;  ///< of faces a ≤ b, at pair(a, b)
};

}  // namespace fringe::detail
