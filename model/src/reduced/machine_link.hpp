#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Geometry>

#include "readings/readings.hpp"
#include "reduced/charge_functions.hpp"
#include "reduced/coarse_charges.hpp"
#include "reduced/surface_resolution.hpp"
#include "surface/placed_box.hpp"

namespace fringe::detail {

/// Bodies of a machine that keep their poses to each other, prepared by themselves: what they carry for the
/// loads with the rest of the machine absent, and functions for all that other charges displace on them.
class MachineLink {
 public:
  /// Prepares nothing, for an archive that has the link.
  MachineLink() = default;
  /// Prepares bodies, joined, in a frame of their own.
  /// @param readings by the potentials of the bodies' conductors
  /// @param loads potentials of these conductors (rows) for all loads of the machine (columns)
  /// @param approach how near the others come to what is sensed or driven, in the frame of these bodies
  /// @param to_targets how near the targets come, in the same frame; without boxes it is not known
  MachineLink(ChargedBodies bodies, const std::vector<ChargedReading>& readings, const Eigen::MatrixXd& loads,
              const Approach& approach, const Approach& to_targets, const SurfaceResolution& resolution);

  const ChargeFunctions& functions() const { return functions_; }
  const CoarseCharges& coarse() const { return coarse_; }
  /// Returns the single-layer matrix of the functions, in 1/m.
  const Eigen::MatrixXf& energies() const { return energies_; }
  /// Returns the loads that the bodies carry: the given charges are those of each and, behind them, what each
  /// lacks with one density on each group of panels.
  const std::vector<Eigen::Index>& loads() const { return loads_; }
  /// Returns the Maxwell matrix of these loads with the rest of the machine absent, in m, and its relative
  /// error.
  const Eigen::MatrixXd& own() const { return own_; }
  double own_error() const { return own_error_; }
  /// Returns the net charges of the functions on the conductors that float, and the capacitances of these to
  /// the ground in m.
  const Eigen::MatrixXf& net() const { return net_; }
  const Eigen::VectorXd& to_ground() const { return to_ground_; }
  /// Returns the largest stated error of the energies of what is sensed, driven or floats, relative to these.
  double error() const { return error_; }
  /// Returns the ratio of that error to the one asked for: more than 1 where the panels did not suffice.
  double excess() const { return excess_; }
  std::size_t panels() const { return functions_.panels().corners.size(); }

  template <typename Archive, typename Self>
  static void describe(Archive& archive, Self& self) {
    archive(self.loads_, self.own_, self.own_error_, self.error_, self.excess_, self.functions_, self.net_,
            self.to_ground_, self.coarse_, self.energies_);
  }

 private:
  MachineLink(const ConductorsAtRest& conductors, const std::vector<ChargedReading>& readings,
              const Eigen::MatrixXd& loads, const Approach& approach, const Approach& to_targets,
              const SurfaceResolution& resolution);

  std::vector<Eigen::Index> loads_;
  Eigen::MatrixXd own_;
  double own_error_ = 0;
  double error_ = 0;
  double excess_ = 0;
  ChargeFunctions functions_;
  Eigen::MatrixXf net_;
  Eigen::VectorXd to_ground_;
  CoarseCharges coarse_;
  Eigen::MatrixXf energies_;
};

}  // namespace fringe::detail
