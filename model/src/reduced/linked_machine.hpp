#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Geometry>

#include "geometry/wrench.hpp"
#include "io/prepared_files.hpp"
#include "readings/readings.hpp"
#include "reduced/machine_link.hpp"
#include "reduced/target_at_rest.hpp"

/// A machine as its links, each of which is prepared by itself; one at rest is one link
/// (model/CORRECTIONS.md, section 8).
namespace fringe::detail {

/// The poses of the frames of a machine's links, and of that of the targets.
struct PoseOfMachine {
  std::vector<Eigen::Isometry3d> links;
  Eigen::Isometry3d target;

  /// Returns the pose of a link; of the targets if it is none.
  const Eigen::Isometry3d& of(std::size_t link) const { return link < links.size() ? links[link] : target; }
  /// Returns the pose from the frame of the targets to that of a link.
  Eigen::Isometry3d of_target(std::size_t link) const {
    return links[link].inverse(Eigen::Isometry) * target;
  }
};

/// A reading by the places of what it senses and drives among the loads of a machine.
struct OfReading {
  Eigen::Index sense;
  Eigen::Index drive;
  double sign;
};

/// A reading that was solved for, in m, to be multiplied by 4πε. Numbers that cannot be found are NaN.
struct SolvedReading {
  double change;      ///< by the targets
  double error;       ///< of the change; infinite: not known
  double background;  ///< the reading without the targets
  double background_error;
};

/// Returns what of an energy, such as one that functions lack, belongs to two loads.
template <typename Energies>
double shared_energy(const Energies& energies, Eigen::Index one, Eigen::Index other) {
  const double first = energies(one, one), second = energies(other, other);
  return std::sqrt(std::max(first, 0.0) * std::max(second, 0.0));
}

/// The parts that the error of a change is stated from.
struct ErrorsOfChange {
  double of_target;        ///< by the targets' functions
  double of_others;        ///< by all else but panels, facets and gaps
  double of_facets;        ///< by the facets of the targets
  double of_given_facets;  ///< by those of the machine, relative to its charges
  double nearness;         ///< the largest ratio of the radius of a function of the targets to its distance
};

/// Returns the error stated of a change; infinity where it is not known.
double stated_error(double change, const TargetAtRest& target, const ErrorsOfChange& errors);

/// The contribution of two groups of bodies to the derivatives of all readings, as the first one moves: in 1
/// and in m, to be multiplied by 4πε.
struct GroupWrenches {
  std::size_t first;  ///< a link; LinkedMachine::none: the targets
  std::size_t second;
  std::vector<Wrench> of_readings;
};

/// How finely the links of a machine are prepared: those with what is sensed or driven, and the others.
struct MachineResolution {
  SurfaceResolution used, others;
};

/// Stated error of the charges of a machine that is prepared roughly.
constexpr double rough_rtol = 3e-2;

/// Returns how finely a machine is prepared for an accuracy.
MachineResolution machine_resolution(double rtol, bool is_rough, bool has_one_link);

/// A machine of links, prepared for a motion.
class LinkedMachine {
 public:
  /// Prepares the links' bodies, joined, each in its own frame. No conductor that floats has bodies on two of
  /// them.
  /// @param poses some poses of the motion; a machine at rest needs none
  /// @param targets boxes around the targets, in their frame; none: they may be anywhere
  /// @param files that keep the links; may be null
  /// @throws InputError for a reading of what is neither a sensor nor an electrode.
  LinkedMachine(std::vector<ChargedBodies> links, const std::vector<Reading>& readings,
                std::span<const PoseOfMachine> poses, const std::vector<Eigen::AlignedBox3d>& targets,
                const MachineResolution& resolutions, std::size_t threads,
                const PreparedFiles* files = nullptr);

  const std::vector<MachineLink>& links() const { return links_; }
  const std::vector<OfReading>& readings() const { return readings_; }
  Eigen::Index loads() const { return loads_; }
  /// Returns the readings by the potentials of the conductors of a link.
  const std::vector<ChargedReading>& readings_on(std::size_t link) const { return charged_[link]; }
  /// Returns boxes around the bodies of a link that are sensed or driven.
  const std::vector<PlacedBox>& used(std::size_t link) const { return used_[link]; }

  /// Returns a reading without targets, in m, to be multiplied by 4πε, and its error, of a machine at rest.
  std::pair<double, double> background(const OfReading& reading) const;

  /// Returns all that the first link was prepared from.
  const std::string& input() const { return input_; }

  /// Returns how near a link comes to what is sensed or driven on the others, in its own frame; `none`: the
  /// targets.
  Approach approach(std::span<const PoseOfMachine> poses, std::size_t link) const;
  static constexpr std::size_t none = static_cast<std::size_t>(-1);

 private:
  std::vector<std::vector<ChargedReading>> charged_;
  std::vector<std::vector<PlacedBox>> used_;
  std::vector<OfReading> readings_;
  Eigen::Index loads_ = 0;
  std::vector<MachineLink> links_;
  std::string input_;
};

/// Returns the largest ratio, in a pose, of the radius of a function of the target to its distance from what
/// is sensed or driven: gaps below it are not resolved.
double nearness(const LinkedMachine& machine, const TargetAtRest& target, const PoseOfMachine& pose);
/// Returns the same for boxes around what is sensed or driven, in a pose from the frame of the targets to
/// theirs.
double nearness(const std::vector<PlacedBox>& used, const TargetAtRest& target,
                const Eigen::Isometry3d& pose);

}  // namespace fringe::detail
