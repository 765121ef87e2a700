#pragma once

#include <cstddef>
#include <memory>
#include <optional>
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

/// The energy that still finer triangles would add, relative to the change from coarser triangles to a body's
/// own. Along edges that are about resolved it was 0.8, on the facets of a ball 0.25.
constexpr double likely_missing = 0.6;

/// When the solver stops extending the reduced basis.
struct ReductionLimits {
  int least_steps;
  int most_steps;
  double accuracy;  ///< steps go on while more than this fraction of an entry may be missing
};

/// The effect of the targets, in the basis of the last solution. X is the charge on the machine without the
/// targets, for every conductor at unit potential, and X + Z that with the targets. Forms have a row and a
/// column for each X and, behind them, for each Z.
struct ReducedChange {
  std::size_t machine_bodies;                   ///< the first bodies; the others are targets
  Eigen::MatrixXd background;                   ///< `values` without the targets
  Eigen::MatrixXd change;                       ///< `values` − `background`, without cancellation
  Eigen::MatrixXd truncation;                   ///< what the residuals contribute
  std::vector<Eigen::MatrixXd> discretisation;  ///< energies of the highest functions of each body
  std::vector<Eigen::MatrixXd> energies;        ///< energies of the charges on each body
  Eigen::MatrixXd facets;                       ///< what the facets of round shapes may add
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
  Eigen::MatrixXd facets;      ///< what the facets of round shapes may add
  Eigen::MatrixXd quadrature;  ///< possible effect of the quadrature errors
  /// Quadrature error of the interaction of each pair of bodies, relative to the roots of their energies.
  Eigen::MatrixXd pair_errors;
  Eigen::MatrixXd couplings;  ///< interaction of each pair of bodies, relative alike
  /// For each body the largest part it has in `discretisation`, relative to the conductor's own capacitance.
  Eigen::VectorXd body_discretisation;
  Eigen::VectorXd delta_self;  ///< of the sensors
  Eigen::VectorXd delta_truncation;
  Eigen::VectorXd delta_discretisation;
  std::optional<ReducedChange> change;  ///< if the system has a machine
  std::size_t vectors = 0;
};

/// Solves for charges in a reduced basis. The bodies of the sensors, which are the first conductors, come
/// first, then those of the rest of the machine, then the targets.
class ReducedSystem {
 public:
  /// `machine_bodies` is the number of bodies with which the change by the others is to be found; none if no
  /// change is asked for.
  ReducedSystem(std::vector<ReducedBody> bodies, std::size_t sensors, std::size_t conductors,
                std::optional<std::size_t> machine_bodies);

  std::vector<ReducedBody>& bodies() { return bodies_; }

  NodePair& pair(std::size_t a, std::size_t b) { return pairs_[a * bodies_.size() + b]; }

  /// Forgets what is known of the machine without the targets. To be called when a pair of its bodies gets
  /// another quadrature.
  void forget_machine() { machine_.reset(); }

  /// Returns the last solution.
  const ReducedSolution& solution() const { return solution_; }

  /// Solves with the pairs' present quadratures.
  const ReducedSolution& solve(const ReductionLimits& limits);

  /// Returns the charges on the bodies' surfaces (rows: those of the first body, then of the second …) of the
  /// last solution, with the corrections of its last residuals, for every conductor at unit potential.
  Eigen::MatrixXd surface_charges();

  /// Returns charges on a body in the last solution, which must have a `change`: coefficients of its
  /// functions in whole blocks, and one more (rows). `combination` has the coefficients of X and Z of every
  /// conductor (rows), as in ReducedChange.
  Eigen::MatrixXf charges_in_change(std::size_t body, const Eigen::MatrixXd& combination);

 private:
  struct Vector {
    std::size_t body;
    float* charge;
    float* moments;
    double net;
    std::vector<float*> potentials;  ///< on every other body; nullptr if not known
  };

  /// The vectors of the machine alone, which serve until it moves or its levels change.
  struct MachineBasis {
    std::vector<int> levels;
    int least_steps;
    std::size_t vectors;
    std::size_t slots;
    std::size_t alone;  ///< number of vectors of the sensors alone
    Eigen::VectorXd truncation_alone;
    Eigen::VectorXd discretisation_alone;
    Eigen::VectorXd coarser_alone;
  };

  /// Arrays for every body and conductor.
  struct Residuals {
    std::vector<float*> moments;
    std::vector<float*> corrections;  ///< charges that make up for the residuals
  };

  float* slot();
  const PreparedLevel& level(std::size_t body) const {
    return bodies_[body].shape->level(bodies_[body].level);
  }
  bool fit_slots();
  void begin();
  bool knows_machine(const ReductionLimits& limits) const;
  void return_to_machine();
  bool solve_machine(const ReductionLimits& limits);
  void lay_residuals(Residuals& residuals);
  Vector& new_vector(std::size_t body);
  void orthogonalise(std::size_t body, float* charge, float* moments);
  void add_equilibrium(std::size_t body);
  void apply_off_diagonal_blocks(std::size_t active);
  void append_factor_rows();
  void substitute_back(std::size_t conductors);
  void compute_residuals(std::size_t active, std::size_t conductors, const Eigen::MatrixXd& charges,
                         Residuals& residuals);
  void sum_truncation(std::size_t active, std::size_t conductors);
  bool append_residuals(std::size_t active, std::size_t conductors);
  void extend_basis(const ReductionLimits& limits, std::size_t active, std::size_t conductors);
  void add_charges(std::size_t body, const Eigen::MatrixXd& combinations, float* to,
                   std::ptrdiff_t stride) const;
  Eigen::MatrixXd form_of_charges(std::size_t body, const std::vector<float>& form,
                                  const std::vector<int>* functions, const Eigen::MatrixXd& charges);
  Eigen::MatrixXd highest_energies(std::size_t body, const Eigen::MatrixXd& charges);
  Eigen::MatrixXd discretisation(std::size_t active, std::size_t conductors);
  Eigen::MatrixXd missing(std::size_t active, std::size_t conductors);
  void find_change();
  Eigen::MatrixXd residual_energies();
  double coupling(std::size_t first, std::size_t second) const;
  void estimate_truncation_left();
  void estimate_quadrature();

  std::vector<ReducedBody> bodies_;
  std::size_t sensors_;
  std::size_t conductors_;
  std::size_t sensor_bodies_ = 0;
  std::optional<std::size_t> machine_bodies_;
  std::vector<NodePair> pairs_;

  std::vector<std::unique_ptr<float[]>> blocks_;
  std::size_t slot_size_ = 0;
  std::size_t slots_used_ = 0;

  std::vector<Vector> vectors_;
  std::vector<std::size_t> equilibria_;  ///< each body's first vector
  std::vector<float> work_;              ///< charges of several columns
  std::vector<float> stiff_;
  std::size_t used_ = 0;               ///< number of vectors in use
  std::size_t extended_ = 0;           ///< number of them in the factor
  std::vector<double> gram_;           ///< products of the vectors, row after row of the lower triangle
  std::vector<double> factor_;         ///< Cholesky factor of it
  Eigen::MatrixXd net_;                ///< factor⁻¹·(net charges), a row for every vector
  Eigen::MatrixXd charges_;            ///< coefficient of every vector, for every conductor at unit potential
  Eigen::MatrixXd charges_in_change_;  ///< those of X and Z for every conductor
  Residuals residuals_;
  Residuals background_residuals_;
  std::optional<MachineBasis> machine_;
  bool positive_definite_ = true;
  ReducedSolution solution_;
};

}  // namespace fringe::detail
