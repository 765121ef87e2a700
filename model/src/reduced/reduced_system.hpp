#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include <Eigen/Core>

#include "reduced/node_pair.hpp"
#include "reduced/prepared_shape.hpp"

/// The Galerkin equations of rigid bodies in a reduced basis of few charge vectors for each
/// (model/BOUNDARY_ELEMENTS.md, section 8). Capacitances are in metres: to be multiplied by 4πε.
namespace fringe::detail {

/// A body of a system; it belongs to one conductor.
struct ReducedBody {
  PreparedShape* shape;
  double scale;
  std::size_t conductor;
  int level = 0;
};

/// When the solver stops extending the reduced basis.
struct ReductionLimits {
  int least_steps;
  int most_steps;
  double accuracy;  ///< steps go on while more than this fraction of an entry may be missing
};

/// Capacitances of all conductors, floating ones included, and estimates of what the approximations leave
/// out.
struct ReducedSolution {
  bool positive_definite = true;  ///< false if the quadratures are too coarse; then nothing else is set
  Eigen::MatrixXd values;
  Eigen::MatrixXd truncation;      ///< contribution of the last residuals to `values`
  double truncation_left = 0;      ///< fraction of it that may still be missing
  Eigen::MatrixXd discretisation;  ///< contribution of the highest functions, or somewhat more
  Eigen::MatrixXd coarser;     ///< contribution that coarser triangles would miss, a part of `discretisation`
  Eigen::MatrixXd quadrature;  ///< possible effect of the quadrature errors
  /// For each body the largest part it has in `discretisation`, relative to the conductor's own capacitance.
  Eigen::VectorXd body_discretisation;
  Eigen::VectorXd delta_self;  ///< of the sensors
  Eigen::VectorXd delta_truncation;
  Eigen::VectorXd delta_discretisation;
  std::size_t vectors = 0;
};

/// Solves for charges in a reduced basis. The bodies of the sensors, which are the first conductors, come
/// first.
class ReducedSystem {
 public:
  ReducedSystem(std::vector<ReducedBody> bodies, std::size_t sensors, std::size_t conductors);

  std::vector<ReducedBody>& bodies() { return bodies_; }

  NodePair& pair(std::size_t a, std::size_t b) { return pairs_[a * bodies_.size() + b]; }

  /// Solves with the pairs' present quadratures.
  const ReducedSolution& solve(const ReductionLimits& limits);

  /// Returns the charges on the bodies' surfaces (rows: those of the first body, then of the second …) of the
  /// last solution, with the corrections of its last residuals, for every conductor at unit potential.
  Eigen::MatrixXd surface_charges();

 private:
  struct Vector {
    std::size_t body;
    float* charge;
    float* moments;
    double net;
    std::vector<float*> potentials;  ///< on every other body; nullptr if not known
  };

  float* slot();
  const PreparedLevel& level(std::size_t body) { return bodies_[body].shape->level(bodies_[body].level); }
  void begin();
  Vector& new_vector(std::size_t body);
  void orthogonalise(std::size_t body, float* charge, float* moments);
  void add_equilibrium(std::size_t body);
  void apply_off_diagonal_blocks(std::size_t active);
  void append_factor_rows();
  void substitute_back(std::size_t conductors);
  void compute_residuals(std::size_t active, std::size_t conductors);
  bool append_residuals(std::size_t active, std::size_t conductors);
  void extend_basis(const ReductionLimits& limits, std::size_t active, std::size_t conductors);
  Eigen::MatrixXd discretisation(std::size_t active, std::size_t conductors);
  Eigen::MatrixXd missing(std::size_t active, std::size_t conductors);
  double coupling(std::size_t first, std::size_t second) const;
  void estimate_truncation_left();
  void estimate_quadrature();

  std::vector<ReducedBody> bodies_;
  std::size_t sensors_;
  std::size_t conductors_;
  std::size_t sensor_bodies_ = 0;
  std::vector<NodePair> pairs_;

  std::vector<std::unique_ptr<float[]>> blocks_;
  std::size_t slot_size_ = 0;
  std::size_t slots_used_ = 0;

  std::vector<Vector> vectors_;
  std::vector<std::size_t> equilibria_;  ///< each body's first vector
  std::vector<float> highest_;           ///< work space
  std::vector<float> stiff_;
  std::size_t used_ = 0;             ///< number of vectors in use
  std::size_t extended_ = 0;         ///< number of them in the factor
  std::vector<double> factor_;       ///< Cholesky factor, row after row of the lower triangle
  Eigen::MatrixXd net_;              ///< factor⁻¹·(net charges), a row for every vector
  Eigen::MatrixXd charges_;          ///< coefficient of every vector, for every conductor at unit potential
  std::vector<float*> residuals_;    ///< moments, for every body and conductor
  std::vector<float*> corrections_;  ///< charges that make up for the residuals
  bool positive_definite_ = true;
  ReducedSolution solution_;
};

}  // namespace fringe::detail
