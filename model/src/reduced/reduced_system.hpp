#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include <Eigen/Core>

#include "reduced/node_pair.hpp"
#include "reduced/prepared_shape.hpp"

/// The Galerkin equations of rigid bodies in few vectors of charge for each (model/BOUNDARY_ELEMENTS.md,
/// section 8). Capacitances are in metres: to be multiplied by 4πε.
namespace fringe::detail {

/// One body of a system: of one conductor.
struct ReducedBody {
  PreparedShape* shape;
  double scale;
  std::size_t conductor;
  int level = 0;
};

/// What steers an answer.
struct ReductionLimits {
  int least_steps;
  int most_steps;
  double accuracy;  ///< steps go on while more than this part of an entry may be missing
};

/// Capacitances of all conductors, floating ones included, and what the approximations may have left out.
struct ReducedSolution {
  bool positive_definite = true;  ///< false: the quadratures are too coarse, nothing else is meant
  Eigen::MatrixXd values;
  Eigen::MatrixXd truncation;  ///< what the last residuals added to `values`
  double truncation_left = 0;  ///< the part of it that may still be missing
  Eigen::MatrixXd resolution;  ///< what the highest functions added, or somewhat more
  Eigen::MatrixXd coarser;     ///< what coarser triangles would lack: a part of `resolution`
  Eigen::MatrixXd quadrature;  ///< what the errors of the quadratures may do
  /// Of each body, the largest of its part of `resolution`, relative to the conductor's own capacitance.
  Eigen::VectorXd body_resolution;
  Eigen::VectorXd delta_self;  ///< of the sensors
  Eigen::VectorXd delta_truncation;
  Eigen::VectorXd delta_resolution;
  std::size_t vectors = 0;
};

/// The bodies of the first conductors, the sensors, come first.
class ReducedSystem {
 public:
  ReducedSystem(std::vector<ReducedBody> bodies, std::size_t sensors, std::size_t conductors);

  std::vector<ReducedBody>& bodies() { return bodies_; }

  NodePair& pair(std::size_t a, std::size_t b) { return pairs_[a * bodies_.size() + b]; }

  /// The answer for the pairs' quadratures as they are.
  const ReducedSolution& solve(const ReductionLimits& limits);

 private:
  struct Vector {
    std::size_t body;
    float* charge;
    float* moments;
    double net;
    std::vector<float*> potentials;  ///< on every other body; nullptr: not known
  };

  float* slot();
  const PreparedLevel& level(std::size_t body) { return bodies_[body].shape->level(bodies_[body].level); }
  void begin();
  Vector& new_vector(std::size_t body);
  void take_out(std::size_t body, float* charge, float* moments);
  void add_equilibrium(std::size_t body);
  void exchange(std::size_t active);
  void extend();
  void find_charges(std::size_t conductors);
  void find_residuals(std::size_t active, std::size_t conductors);
  bool add_residuals(std::size_t active, std::size_t conductors);
  void iterate(const ReductionLimits& limits, std::size_t active, std::size_t conductors);
  Eigen::MatrixXd resolution(std::size_t active, std::size_t conductors);
  Eigen::MatrixXd missing();
  double coupling(std::size_t first, std::size_t second) const;
  void judge_truncation();
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
  std::vector<std::size_t> equilibria_;  ///< the bodies' first vectors
  std::vector<float> highest_;           ///< work space
  std::vector<float> stiff_;
  std::size_t used_ = 0;             ///< of the vectors
  std::size_t extended_ = 0;         ///< of them in the factor
  std::vector<double> factor_;       ///< Cholesky's, row after row of the lower triangle
  Eigen::MatrixXd net_;              ///< factor⁻¹·(net charges), a row for every vector
  Eigen::MatrixXd charges_;          ///< how much of every vector, for every conductor at a potential of one
  std::vector<float*> residuals_;    ///< of every body and conductor, as moments
  std::vector<float*> corrections_;  ///< the charges that would answer them
  bool positive_definite_ = true;
  ReducedSolution solution_;
};

}  // namespace fringe::detail
