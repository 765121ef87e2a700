#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include <Eigen/Geometry>

#include "reduced/answer_modes.hpp"
#include "reduced/linked_machine.hpp"
#include "reduced/outside_potentials.hpp"
#include "reduced/potential_table.hpp"
#include "reduced/table_forces.hpp"

namespace fringe::detail {

/// A machine at rest as targets feel it where they move: the potentials of its charges, and of the modes by
/// which it answers, tabulated.
class TabulatedMachine {
 public:
  /// Prepares nothing yet. Keeps a reference to the machine, which is one link.
  TabulatedMachine(const LinkedMachine& machine, const TargetAtRest& target);
  TabulatedMachine(const TabulatedMachine&) = delete;
  TabulatedMachine& operator=(const TabulatedMachine&) = delete;

  /// Prepares what targets meet in some poses; costs little where they have been near before. The same bits
  /// for any number of threads.
  void extend(const TargetAtRest& target, std::span<const Eigen::Isometry3d> poses, std::size_t threads);

  const LinkedMachine& machine() const { return machine_; }
  const MachineLink& link() const { return machine_.links().front(); }
  /// Returns the number of charges that the functions are given: those of the loads, and what these lack with
  /// one density on each group of panels.
  Eigen::Index given() const { return link().functions().panels().given.cols(); }
  const OutsidePotentials& potentials() const { return potentials_; }
  const AnswerModes& modes() const { return modes_; }
  const PotentialTable& table() const { return table_; }

  template <typename Archive, typename Self>
  static void describe(Archive& archive, Self& self) {
    archive(self.table_, self.modes_, self.places_);
  }

 private:
  const LinkedMachine& machine_;
  OutsidePotentials potentials_;
  PotentialTable table_;
  Eigen::MatrixXd root_;  ///< of the machine's answers, once it is needed
  AnswerModes modes_;
  std::size_t places_ = 0;  ///< number of cells for which the modes were chosen
};

/// Evaluates what targets change before a machine at rest: conjugate gradients for the target's matrix with
/// the machine grounded, preconditioned by that of the target alone, for all loads at once, with the
/// potentials of a tabulated machine (model/CORRECTIONS.md, section 8). After the first pose of a machine and
/// targets it allocates no memory, but for points that lie in no cell.
class TabulatedSolver {
 public:
  /// Returns the changes with all charges that the target's functions can carry, within `rtol` of these, in
  /// m, to be multiplied by 4πε; valid until the next call.
  const std::vector<SolvedReading>& solved(const TabulatedMachine& machine, const TargetAtRest& target,
                                           const Eigen::Isometry3d& pose, double rtol);

  /// Returns the derivatives of the changes that solved() has just found, as the target moves: in 1 and in m,
  /// in the frame of the machine, to be multiplied by 4πε. By the stationarity of the energy the charges do
  /// not change to first order, so that these are the forces on them.
  const std::vector<Wrench>& wrenches(const TabulatedMachine& machine, const TargetAtRest& target,
                                      const Eigen::Isometry3d& pose);

 private:
  /// A point that lies in no cell, a share of a function.
  struct Outside {
    Eigen::Vector3d at;
    Eigen::Index function;
    float share;
  };

  void find_potentials(const TabulatedMachine& machine, const TargetAtRest& target,
                       const Eigen::Isometry3d& pose);
  void prepare(const TabulatedMachine& machine, const TargetAtRest& target);
  void find_outside(const TabulatedMachine& machine);
  void find_outside_forces(const TabulatedMachine& machine);
  void start(const TabulatedMachine& machine, const TargetAtRest& target);
  void add_direction(const TabulatedMachine& machine);
  void extend_form(Eigen::Index before);
  void solve_coefficients();
  void solve_form(const TargetAtRest& target);
  void state_errors(const TabulatedMachine& machine, const TargetAtRest& target, double nearness);

  TrianglePotentials
      seen_;  ///< potentials of the given charges, then of the modes, on the target's functions (rows)
  std::vector<Outside> outside_;
  TablePotentials table_potentials_;

  Eigen::Index count_ = 0;  ///< number of directions of the charge on the target; arrays have rows or columns
                            ///< for the largest one
  Eigen::Index loads_ = 0;  ///< of the readings; then come those of what floats
  Eigen::MatrixXf right_;   ///< potentials (columns) that the charges are to have
  Eigen::MatrixXf charges_;     ///< of the functions (rows) in each direction
  Eigen::MatrixXf own_;         ///< their potentials by themselves
  Eigen::MatrixXf images_;      ///< their potentials before the machine
  TrianglePotentials moments_;  ///< of each direction (row) with the given charges' potentials and the modes
  std::vector<float> of_modes_, sums_;  ///< for everything that is tabulated
  std::vector<float> none_;             ///< zeros for these
  std::vector<float> of_rows_;
  Eigen::MatrixXd form_, sides_;
  Eigen::MatrixXd coefficients_;  ///< of the directions (rows) for each right side
  Eigen::MatrixXd charged_;       ///< the same for each load, with the net charges of what floats
  Eigen::MatrixXd changes_;
  // Holds intermediate results, so that later poses allocate no memory.
  Eigen::MatrixXf energies_, chosen_, residual_, on_target_, potentials_, all_moments_, answers_, unanswered_,
      shifts_;
  Eigen::MatrixXd factor_;
  Eigen::VectorXd column_;
  FloatingCharges floating_charges_;
  CoarseCharges::Workspace lacking_;
  std::vector<double> before_;
  std::vector<SolvedReading> solved_;

  TableForces table_forces_;
  Eigen::MatrixXf fields_;  ///< of the loads (columns) and the answers to them, by what is tabulated
  Forces forces_;
  std::vector<Wrench> wrenches_;
};

}  // namespace fringe::detail
