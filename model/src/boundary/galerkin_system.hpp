#pragma once

#include <vector>

#include <Eigen/Core>

#include "charged_bodies.hpp"
#include "face.hpp"

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

/// The functions of the smaller space along a direction with an odd number of functions, 3 or more.
int coarse_functions(int functions);

class GalerkinSystem {
 public:
  explicit GalerkinSystem(const ChargedBodies& bodies);

  std::size_t faces() const { return faces_.size(); }

  /// Evaluates the matrices for so many functions on each face; those that are known are kept.
  void refine(const std::vector<FaceFunctions>& functions, double tolerance);

  GalerkinSolution solve() const;

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
  std::vector<Face> faces_;
  std::vector<std::size_t> body_of_;     ///< of each face
  std::vector<std::size_t> first_face_;  ///< of each body
  std::vector<FaceFunctions> functions_;
  std::vector<Block> blocks_;  ///< of faces a ≤ b, at pair(a, b)
};

}  // namespace fringe::detail
