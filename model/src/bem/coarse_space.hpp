#pragma once

#include <vector>

#include <Eigen/Cholesky>
#include <Eigen/Core>

#include "bem/panel_equations.hpp"

namespace fringe::detail {

/// The faces' functions and one density on each group of panels, solved for by Cholesky's factor: those of
/// the smaller space first, then the groups, then the faces' other functions. With the inverses of the
/// groups' own blocks it nearly inverts the whole matrix.
class NestedSpace {
 public:
  explicit NestedSpace(const PanelEquations& equations);

  bool is_positive_definite() const { return is_positive_definite_; }

  /// Of each panel in its group's area.
  const Eigen::VectorXd& shares() const { return shares_; }

  /// The charges for a right side, and what the smaller space makes of it: a column whose scalar products
  /// with those of other right sides are its energies.
  Eigen::VectorXd solve(const Eigen::VectorXd& right_side, Eigen::VectorXd& smaller) const;

  Eigen::VectorXd preconditioned(const Eigen::VectorXd& residual) const;

 private:
  Eigen::MatrixXd matrix();
  Eigen::Index place(std::size_t function) const;
  Eigen::VectorXd restricted(const Eigen::VectorXd& full) const;
  Eigen::VectorXd prolonged(const Eigen::VectorXd& nested) const;

  const PanelEquations& equations_;
  Eigen::Index group_count_;
  Eigen::Index coarse_;
  Eigen::VectorXd shares_;
  std::vector<Eigen::LLT<Eigen::MatrixXd>> groups_;  ///< of each group's panels
  Eigen::LLT<Eigen::MatrixXd> factor_;
  bool is_positive_definite_ = true;
};

}  // namespace fringe::detail
