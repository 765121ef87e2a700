#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Geometry>

#include "correction/charge_functions.hpp"
#include "fringe/scene.hpp"

/// The formula that knows company: what targets change in the readings of a machine at rest
/// (model/CORRECTIONS.md, section 8).
namespace fringe::detail {

/// How finely a machine is resolved.
struct MachineResolution {
  double rtol = 3e-2;              ///< stated error at which the refinement of its charges ends
  std::size_t most_panels = 6000;  ///< refinement ends there, too
  std::size_t functions = 200;     ///< largest number of parts of its surface
  std::size_t threads = 1;         ///< 0: as many as this process may run at once
};

/// What does not change while targets move: the charges of the readings' conductors, and how the machine
/// answers to charges outside it.
class MachineAtRest {
 public:
  /// Prepares the conductors of a machine, in world coordinates, for readings of them.
  /// @throws InputError for a reading of what is neither a sensor nor an electrode.
  MachineAtRest(ChargedBodies bodies, const std::vector<Reading>& readings,
                const MachineResolution& resolution = {});

  /// A reading by the places of what it senses and drives among the given charges of the functions.
  struct OfReading {
    Eigen::Index sense;
    Eigen::Index drive;
    double sign;
  };

  const ChargeFunctions& functions() const { return functions_; }
  const std::vector<OfReading>& readings() const { return readings_; }
  /// Returns boxes around the bodies that are sensed or driven.
  const std::vector<Eigen::AlignedBox3d>& used() const { return used_; }
  Eigen::Index loads() const { return functions_.points(0).given.cols(); }
  /// Returns the charges of the functions by their potentials, floating conductors without net charge: a
  /// symmetric matrix in whole blocks.
  const std::vector<float>& answers() const { return answers_; }
  /// Returns the largest stated error of the energies of what is sensed, driven or floats, relative to these.
  double error() const { return error_; }

 private:
  MachineAtRest(const ConductorsAtRest& conductors, const std::vector<Reading>& readings,
                std::size_t most_functions);

  std::vector<OfReading> readings_;
  std::vector<Eigen::AlignedBox3d> used_;
  double error_;
  ChargeFunctions functions_;
  std::vector<float> answers_;
};

/// The targets, which keep their poses to each other.
class TargetAtRest {
 public:
  explicit TargetAtRest(ChargedBodies bodies);

  const ChargeFunctions& functions() const { return functions_; }
  Eigen::Index conductors() const { return equilibrium_.cols(); }
  /// Returns the charges of the functions by their potentials with no one else there, in whole blocks.
  const std::vector<float>& inverse() const { return inverse_; }
  /// Returns the charges of the functions (rows) for each conductor at unit potential, the others grounded.
  const Eigen::MatrixXd& equilibrium() const { return equilibrium_; }
  /// Returns the Maxwell matrix of the targets by themselves, in m.
  const Eigen::MatrixXd& own() const { return own_; }
  /// Returns the numbers of the conductors that are not grounded, and their capacitances to the ground in m.
  const std::vector<Eigen::Index>& floating() const { return floating_; }
  const Eigen::VectorXd& to_ground() const { return to_ground_; }

 private:
  explicit TargetAtRest(const ConductorsAtRest& conductors);

  ChargeFunctions functions_;
  std::vector<float> inverse_;
  Eigen::MatrixXd equilibrium_;
  Eigen::MatrixXd own_;
  std::vector<Eigen::Index> floating_;
  Eigen::VectorXd to_ground_;
};

/// Evaluates what targets change, pose by pose.
class CompanyFormula {
 public:
  /// Returns the change of every reading in m, to be multiplied by 4πε; valid until the next call.
  ///
  /// @param pose from the frame of the targets to that of the machine
  const std::vector<double>& changes(const MachineAtRest& machine, const TargetAtRest& target,
                                     const Eigen::Isometry3d& pose);

  /// Returns the largest ratio, in the last pose, of the radius of a function of the target to its distance
  /// from what is sensed or driven: gaps below it are not resolved.
  double nearness() const { return nearness_; }

 private:
  /// Points of functions, in the frame of the machine.
  struct Points {
    std::vector<std::size_t> levels;  ///< of every function
    std::vector<float> x, y, z, shares, charges, potentials;
    std::size_t count = 0;
  };

  void place_target(const MachineAtRest& machine, const TargetAtRest& target, const Eigen::Isometry3d& pose);
  void place_machine(const MachineAtRest& machine, const TargetAtRest& target, const Eigen::Isometry3d& pose);
  void find_potentials(const MachineAtRest& machine, const TargetAtRest& target);
  void find_answers(const MachineAtRest& machine, const TargetAtRest& target);
  void combine(const MachineAtRest& machine, const TargetAtRest& target);
  static void gather(const Points& points, const ChargeFunctions& functions, float* of_functions);
  static void spread(const ChargeFunctions& functions, const float* of_functions, Points& points);

  Points target_, machine_;
  std::vector<std::vector<float>> given_;       ///< the machine's given charges at its points
  std::vector<float> distances_;                ///< 1/r of the target's points (rows) and the machine's
  std::vector<std::vector<float>> by_given_;    ///< potentials of the given charges on the target's functions
  std::vector<std::vector<float>> charges_;     ///< the charges of the target's functions in each direction
  std::vector<std::vector<float>> on_machine_;  ///< their potentials on the machine's functions
  std::vector<float> answer_;
  Eigen::MatrixXd form_;        ///< energies of the directions before the machine
  Eigen::MatrixXd potentials_;  ///< of the given charges (columns) by direction
  Eigen::MatrixXd net_;         ///< net charges of the directions on each target conductor (columns)
  double nearness_ = 0;
  std::vector<double> changes_;
};

}  // namespace fringe::detail
