#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Geometry>

#include "correction/company.hpp"
#include "io/prepared_files.hpp"

/// Surrounding conductors for machines whose links move against each other (model/CORRECTIONS.md, section 8,
/// "Links that move").
namespace fringe::detail {

/// The poses of the frames of a machine's links, and of that of the targets.
struct PoseOfMachine {
  std::vector<Eigen::Isometry3d> links;
  Eigen::Isometry3d target;
};

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
  /// @param to_targets how near the targets come, in the same frame
  MachineLink(ChargedBodies bodies, const std::vector<ChargedReading>& readings, const Eigen::MatrixXd& loads,
              const Approach& approach, const Approach& to_targets, const CompanyResolution& resolution);

  const ChargeFunctions& functions() const { return functions_; }
  const CoarseCharges& coarse() const { return coarse_; }
  /// Returns the single-layer matrix of the functions, in 1/m.
  const Eigen::MatrixXf& energies() const { return energies_; }
  /// Returns the loads that the bodies carry: the given charges are those of each and, behind them, what each
  /// lacks with one density on each group of panels.
  const std::vector<Eigen::Index>& loads() const { return loads_; }
  /// Returns the net charges of the functions on the conductors that float, and the capacitances of these to
  /// the ground in m.
  const Eigen::MatrixXf& net() const { return net_; }
  const Eigen::VectorXd& to_ground() const { return to_ground_; }
  /// Returns the ratio of the error of the charges to the one asked for.
  double excess() const { return excess_; }
  std::size_t panels() const { return functions_.panels().corners.size(); }

  template <typename Archive, typename Self>
  static void describe(Archive& archive, Self& self) {
    archive(self.loads_, self.excess_, self.functions_, self.net_, self.to_ground_, self.coarse_,
            self.energies_);
  }

 private:
  MachineLink(const ConductorsAtRest& conductors, const std::vector<ChargedReading>& readings,
              const Eigen::MatrixXd& loads, const Approach& approach, const Approach& to_targets,
              const CompanyResolution& resolution);

  std::vector<Eigen::Index> loads_;
  double excess_ = 0;
  ChargeFunctions functions_;
  Eigen::MatrixXf net_;
  Eigen::VectorXd to_ground_;
  CoarseCharges coarse_;
  Eigen::MatrixXf energies_;
};

/// A machine of links, prepared for a motion.
class MovingMachine {
 public:
  /// Prepares the links' bodies, joined, each in its own frame. No conductor that floats has bodies on two of
  /// them.
  /// @param poses the poses of the links' frames, for each of some poses of the motion
  /// @param targets boxes around the targets, in a frame of their own
  /// @param of_targets the poses of that frame
  /// @param files that keep the links; may be null
  /// @throws InputError for a reading of what is neither a sensor nor an electrode.
  MovingMachine(std::vector<ChargedBodies> links, const std::vector<Reading>& readings,
                const std::vector<std::vector<Eigen::Isometry3d>>& poses,
                const std::vector<Eigen::AlignedBox3d>& targets,
                const std::vector<Eigen::Isometry3d>& of_targets, double rtol, std::size_t threads,
                const PreparedFiles* files = nullptr);

  const std::vector<MachineLink>& links() const { return links_; }
  const std::vector<MachineAtRest::OfReading>& readings() const { return readings_; }
  Eigen::Index loads() const { return loads_; }
  /// Returns the readings by the potentials of the conductors of a link.
  const std::vector<ChargedReading>& readings_on(std::size_t link) const { return charged_[link]; }
  /// Returns boxes around the bodies of a link that are sensed or driven.
  const std::vector<PlacedBox>& used(std::size_t link) const { return used_[link]; }

  /// Returns how near a body comes to what is sensed or driven, in its own frame; `skipped` is a link whose
  /// own boxes are left out.
  /// @param frames the poses of the body's frame
  Approach approach(const std::vector<Eigen::Isometry3d>& frames,
                    const std::vector<std::vector<Eigen::Isometry3d>>& poses, std::size_t skipped) const;
  static constexpr std::size_t none = static_cast<std::size_t>(-1);

 private:
  std::vector<std::vector<ChargedReading>> charged_;
  std::vector<std::vector<PlacedBox>> used_;
  std::vector<MachineAtRest::OfReading> readings_;
  Eigen::Index loads_ = 0;
  std::vector<MachineLink> links_;
};

}  // namespace fringe::detail
