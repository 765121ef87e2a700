#pragma once

#include <optional>
#include <vector>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>

#include "geometry/wrench.hpp"
#include "reduced/link_couplings.hpp"
#include "reduced/link_tables.hpp"
#include "reduced/linked_machine.hpp"
#include "reduced/packed_factor.hpp"
#include "reduced/table_forces.hpp"

namespace fringe::detail {

/// Evaluates what targets change in the readings of a machine whose links move, pose by pose
/// (model/CORRECTIONS.md, section 8, "Links that move"). Couplings of links that have kept their relative
/// pose since the last pose are kept, and arrays are used again: after the first pose no memory is allocated.
class MovingSolver {
 public:
  /// Returns all readings; NaN where the equations cannot be solved, as where charges of two bodies lie in
  /// each other.
  ///
  /// @param tables with what is met in this pose
  const std::vector<SolvedReading>& solved(const LinkedMachine& machine, const LinkTables& tables,
                                           const TargetAtRest& target, const PoseOfMachine& pose);

  /// Returns the derivatives, in the world, of the changes that solved() has just found in the same poses. By
  /// the stationarity of the energy the charges do not change to first order, so that these are the forces on
  /// them.
  std::vector<GroupWrenches> wrenches(const LinkedMachine& machine, const LinkTables& tables,
                                      const TargetAtRest& target, const PoseOfMachine& poses);

 private:
  void prepare(const LinkedMachine& machine, const TargetAtRest& target);
  void couple(const LinkedMachine& machine, const LinkTables& tables, const TargetAtRest& target,
              const PoseOfMachine& pose);
  void add_given(const LinkedMachine& machine);
  void fill_machine(const LinkedMachine& machine, float ridge);
  void fill_target(const TargetAtRest& target, float ridge);
  bool factorise(const LinkedMachine& machine, const TargetAtRest& target);
  void solve_floating(const LinkedMachine& machine);
  void find_backgrounds(const LinkedMachine& machine);
  void solve(const TargetAtRest& target);
  void find_charges();
  void state_errors(const LinkedMachine& machine, const TargetAtRest& target, double nearness);

  Eigen::Index target_row(Eigen::Index function) const { return first_target_ + function; }
  /// Returns the number of functions of all links.
  Eigen::Index of_machine() const { return first_[first_.size() - 2]; }
  Eigen::Index side_row(Eigen::Index side) const { return factor_.rows() + side; }

  LinkCoupler coupler_;
  BesideLink beside_;
  /// The couplings of every pair of groups, which are the links and, last, the targets: those of the first
  /// group with all later ones come first.
  std::vector<LinkCoupling> couplings_;
  std::vector<Eigen::Index> first_;  ///< the place of each group's first function, and the end
  Eigen::MatrixXf given_;  ///< potentials of the given charges on all functions, and of what these lack
  /// Energies of what links carry for two loads (rows and columns) with each other, and behind them those
  /// with what the loads of the columns lack.
  Eigen::MatrixXd mutual_;
  Eigen::MatrixXd own_, backgrounds_;   ///< of the loads: each link's alone, and of all links together
  Eigen::MatrixXf energies_of_target_;  ///< its single-layer matrix
  Eigen::VectorXf scales_;              ///< of the functions of all links, and behind them the target's

  /// The matrix of all functions, those of the links and the target's, each filled up to whole blocks, with
  /// functions of unit energy. The right sides are the loads, the unit potentials of what floats in the
  /// machine, and those of what floats among the targets.
  PackedFactor factor_;
  std::optional<float> ridge_;            ///< part that was added to the machine's diagonal
  std::optional<float> ridge_of_target_;  ///< the same for the target
  Eigen::Index first_target_ = 0;
  Eigen::Index floating_ = 0;       ///< number of conductors of the machine that float
  Eigen::MatrixXd floating_block_;  ///< of their net charges
  Eigen::LLT<Eigen::MatrixXd> of_floating_;
  Eigen::MatrixXd on_floating_;  ///< what targets (first) and loads put on these, solved by the factor
  Eigen::MatrixXd taken_;        ///< and what these take of it
  Eigen::MatrixXd right_, net_;  ///< of the loads and of the targets that float, solved
  Eigen::MatrixXd answer_, changes_;
  FloatingCharges floating_charges_;
  std::vector<float> vectors_;         ///< of the answers to the targets, then to the given charges
  Eigen::MatrixXf charges_on_target_;  ///< for each load
  Eigen::MatrixXf answered_;           ///< charges of the machine's functions that answer the targets'
  Eigen::MatrixXf background_;         ///< and those that answer the given charges, as with no targets
  Eigen::MatrixXf potentials_, shifts_, shifts_of_background_;
  Eigen::MatrixXd unanswered_;
  CoarseCharges::Workspace lacking_;
  /// The charges of a link and their potentials, and what their sums lack.
  struct OfLink {
    Eigen::MatrixXf charges, potentials;
    CoarseCharges::Workspace lacking;
  };
  std::vector<OfLink> of_links_;
  Forces forces_;
  std::vector<SolvedReading> solved_;
};

}  // namespace fringe::detail
