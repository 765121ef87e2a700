#pragma once

#include <vector>

#include <Eigen/Geometry>

#include "correction/company.hpp"
#include "correction/link_couplings.hpp"
#include "correction/link_tables.hpp"
#include "correction/moving_machine.hpp"

namespace fringe::detail {

/// Evaluates what targets change in the readings of a machine whose links move, pose by pose
/// (model/CORRECTIONS.md, section 8, "Links that move"). Couplings of links that have kept their relative
/// pose since the last pose are kept.
class MovingFormula {
 public:
  /// Returns the changes of all readings in m, to be multiplied by 4πε, and the errors stated.
  ///
  /// @param tables with what is met in these poses
  /// @param links the poses of the links' frames
  /// @param frame the pose of the targets' frame
  const std::vector<CompanyFormula::Change>& solved(const MovingMachine& machine, const LinkTables& tables,
                                                    const TargetAtRest& target,
                                                    const std::vector<Eigen::Isometry3d>& links,
                                                    const Eigen::Isometry3d& frame);

  /// Returns the largest ratio, in a pose, of the radius of a function of the target to its distance from
  /// what is sensed or driven.
  static double nearness(const MovingMachine& machine, const TargetAtRest& target,
                         const std::vector<Eigen::Isometry3d>& links, const Eigen::Isometry3d& frame);

 private:
  /// The machine's answers to potentials: its matrix of all links' functions, factorised, with functions of
  /// unit energy.
  struct Answers {
    Eigen::VectorXf scales;
    Eigen::MatrixXf factor;
    Eigen::MatrixXf floating;        ///< unit potentials of conductors that float, solved by the factor
    Eigen::MatrixXf floating_block;  ///< the factor of the matrix of their net charges
  };

  void couple(const MovingMachine& machine, const LinkTables& tables, const TargetAtRest& target,
              const std::vector<Eigen::Isometry3d>& links, const Eigen::Isometry3d& frame);
  void assemble(const MovingMachine& machine, const TargetAtRest& target);
  void factorise(const MovingMachine& machine);
  void project(const Eigen::MatrixXf& solved, Eigen::MatrixXf& on_floating) const;
  Eigen::MatrixXf charges(Eigen::MatrixXf solved, const Eigen::MatrixXf& on_floating) const;

  LinkCoupler coupler_;
  std::vector<LinkCoupling>
      between_links_;  ///< of every pair of links, the first one's with all later ones first
  std::vector<LinkCoupling> with_target_;   ///< of the targets (first) with every link
  std::vector<Eigen::Index> first_;         ///< the place of each link's first function, and the end
  Eigen::MatrixXf matrix_;                  ///< of all links' functions
  Eigen::MatrixXf coupling_;                ///< potentials of the target's functions (columns) on the links'
  Eigen::MatrixXf on_machine_, on_target_;  ///< potentials of the given charges, and of what these lack
  Answers answers_;
  std::vector<CompanyFormula::Change> solved_;
};

}  // namespace fringe::detail
