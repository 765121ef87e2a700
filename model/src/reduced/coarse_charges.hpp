#pragma once

#include <Eigen/Cholesky>

#include "reduced/charge_functions.hpp"
#include "surface/bodies.hpp"

/// The charges that functions take at given potentials, and what half as many functions lose of their energy
/// (model/CORRECTIONS.md, section 8).
namespace fringe::detail {

/// Returns the capacitances to the ground of the conductors that float, in m.
Eigen::VectorXd to_ground_of(const ChargedBodies& bodies);

/// Returns the net charges of functions on the conductors that float (columns).
Eigen::MatrixXd net_on_floating(const ChargeFunctions& functions, const ChargedBodies& bodies);

/// Takes from charges what conductors that float cannot have: their net charges are those of their
/// capacitances to the ground. Allocates no memory once it has had the sizes.
class FloatingCharges {
 public:
  /// @param net the net charges on the conductors (columns) by the functions (rows)
  /// @param responses charges of the functions for each conductor at unit potential
  /// @param charges of the functions for some potentials (columns) with these conductors grounded
  void take(const Eigen::Ref<const Eigen::MatrixXd>& net, const Eigen::Ref<const Eigen::MatrixXd>& responses,
            const Eigen::VectorXd& to_ground, Eigen::Ref<Eigen::MatrixXd> charges);

 private:
  Eigen::MatrixXd block_, taken_;
  Eigen::LLT<Eigen::MatrixXd> factor_;
};

/// Returns the inverse of a single-layer matrix. Functions that coincide up to rounding share their charge.
Eigen::MatrixXd charges_by_potentials(const Eigen::MatrixXd& energies);
/// Returns the same with floating conductors: `net` has the net charges on them, `to_ground` their
/// capacitances to the ground.
Eigen::MatrixXd charges_by_potentials(const Eigen::MatrixXd& energies, const Eigen::MatrixXd& net,
                                      const Eigen::VectorXd& to_ground);

/// Charges in the sums of neighbouring functions: the defect of a charge is the energy that these lack.
class CoarseCharges {
 public:
  /// Prepares nothing, for an archive that has the sums.
  CoarseCharges() = default;
  /// Prepares the sums, without net charge on conductors that float: `net` has the charges of the functions
  /// on each of these.
  CoarseCharges(const ChargeFunctions& functions, const Eigen::MatrixXd& net,
                const Eigen::VectorXd& to_ground);
  /// Returns how much less energy, of given potentials, the sums take than the charges (columns) that are the
  /// functions' own answer to them.
  Eigen::MatrixXd defects(const Eigen::MatrixXf& charges, const Eigen::MatrixXf& potentials) const;

  /// Arrays for defects of the same numbers of charges, one after the other.
  struct Workspace {
    Eigen::MatrixXf sums, answers, energies, of_sums;
    Eigen::MatrixXd defects;
  };
  /// Finds the same in a workspace, without allocating memory once that has the sizes.
  void find_defects(const Eigen::MatrixXf& charges, const Eigen::MatrixXf& potentials,
                    Workspace& workspace) const;

  template <typename Archive, typename Self>
  static void describe(Archive& archive, Self& self) {
    archive(self.functions_, self.inverse_);
  }

 private:
  CoarseFunctions functions_;
  Eigen::MatrixXf inverse_;
};

}  // namespace fringe::detail
