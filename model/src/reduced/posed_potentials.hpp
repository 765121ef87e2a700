#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "reduced/outside_potentials.hpp"

namespace fringe::detail {

/// The potentials of a machine's charges at the points of several bodies, one body after the other.
class PosedPotentials {
 public:
  /// Keeps references.
  /// @param answers the charges on the functions with which the machine answers: the products of their
  /// potentials make the answer's
  PosedPotentials(const OutsidePotentials& potentials, const FunctionCharges& answers)
      : potentials_(potentials), answers_(answers) {}

  /// Finds the potentials at all points.
  void evaluate(std::span<const Eigen::Vector3d> points);

  /// Returns the potentials of the given charges (columns) at `count` points from `first` on.
  Eigen::MatrixXd given(std::size_t first, Eigen::Index count) const;
  /// Returns the potentials at these points of the machine's answers to unit charges there, with the sign
  /// turned, in 1/m.
  Eigen::MatrixXd answers(std::size_t first, Eigen::Index count);

 private:
  const OutsidePotentials& potentials_;
  const FunctionCharges& answers_;
  OutsidePotentials::Scratch scratch_;
  std::vector<float> of_given_, of_answers_;  ///< for every point a row
  std::vector<float> own_, products_;
};

}  // namespace fringe::detail
