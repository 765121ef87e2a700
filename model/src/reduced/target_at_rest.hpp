#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include <Eigen/Geometry>

#include "reduced/charge_functions.hpp"
#include "reduced/coarse_charges.hpp"
#include "reduced/surface_resolution.hpp"
#include "surface/placed_box.hpp"

namespace fringe::detail {

/// The targets, which keep their poses to each other.
class TargetAtRest {
 public:
  /// Prepares nothing, for an archive that has the targets.
  TargetAtRest() = default;
  /// Prepares the targets, the finer the nearer they come to what is sensed or driven.
  TargetAtRest(ChargedBodies bodies, const SurfaceResolution& resolution, const Approach& approach);

  const ChargeFunctions& functions() const { return functions_; }
  Eigen::Index conductors() const { return equilibrium_.cols(); }
  /// Returns the charges of the functions by their potentials with no one else there, in whole blocks.
  const std::vector<float>& inverse() const { return inverse_; }
  /// Returns the charges of the functions (rows) for each conductor at unit potential, the others grounded.
  const Eigen::MatrixXd& equilibrium() const { return equilibrium_; }
  /// Returns the net charges of the functions on each conductor.
  const Eigen::MatrixXd& net() const { return net_; }
  /// Returns the numbers of the conductors that are not grounded, and their capacitances to the ground in m.
  const std::vector<Eigen::Index>& floating() const { return floating_; }
  const Eigen::VectorXd& to_ground() const { return to_ground_; }
  const CoarseCharges& coarse() const { return coarse_; }
  /// Returns the distance of a function's part of the surface from a box of the machine.
  ///
  /// @param pose from the frame of the targets to that of the box
  double distance(std::size_t function, const PlacedBox& box, const Eigen::Isometry3d& pose) const;
  /// Returns the diagonal of a box around all targets, in m.
  double size() const;
  /// Returns the error of a change by the panels: the stated one of the targets' own charges, which counts
  /// all parts of them. Where this exceeds what was asked for, it is limited by what half as many functions
  /// lose of the change, which is more than what the panels lose: a function has several of them.
  double error_of_panels(double change, double of_functions) const {
    return std::min(error_ * std::abs(change), std::max(rtol_ * std::abs(change), of_functions));
  }

  template <typename Archive, typename Self>
  static void describe(Archive& archive, Self& self) {
    archive(self.functions_, self.parts_, self.coarse_, self.inverse_, self.net_, self.equilibrium_,
            self.floating_, self.to_ground_, self.rtol_, self.error_);
  }

 private:
  TargetAtRest(const ConductorsAtRest& conductors, const SurfaceResolution& resolution,
               const Approach& approach);

  ChargeFunctions functions_;
  std::vector<PlacedBox> parts_;  ///< around the part of every function
  CoarseCharges coarse_;
  std::vector<float> inverse_;
  Eigen::MatrixXd net_;
  Eigen::MatrixXd equilibrium_;
  std::vector<Eigen::Index> floating_;
  Eigen::VectorXd to_ground_;
  double rtol_ = 0;  ///< asked for
  double error_ = 0;
};

}  // namespace fringe::detail
