#pragma once

#include <cstddef>
#include <span>

#include <Eigen/Core>

#include "reduced/machine_link.hpp"
#include "reduced/outside_potentials.hpp"

namespace fringe::detail {

/// The few combinations of a machine's functions with which it answers charges in a region: orthonormal in
/// the energy, so that a charge whose potentials on them are v lowers its energy by v² (model/CORRECTIONS.md,
/// section 8).
struct AnswerModes {
  Eigen::MatrixXf charges;  ///< of the functions (rows) in each mode
  /// The part of the energies v_i v_j that sums of neighbouring functions do not answer.
  Eigen::MatrixXf missing;

  template <typename Archive, typename Self>
  static void describe(Archive& archive, Self& self) {
    archive(self.charges, self.missing);
  }
};

/// Returns a root of the matrix by which a machine at rest answers potentials on its functions with charges:
/// the root times its transpose is the matrix.
Eigen::MatrixXd root_of_answers(const MachineLink& machine);

/// Returns the modes that answer unit charges at given places best, in the mean of the energies, the most
/// important ones first.
///
/// @param root root_of_answers(machine)
/// @param most the largest number of modes
AnswerModes answer_modes(const MachineLink& machine, const Eigen::MatrixXd& root,
                         const OutsidePotentials& potentials, std::span<const Eigen::Vector3d> places,
                         Eigen::Index most, std::size_t threads);

}  // namespace fringe::detail
