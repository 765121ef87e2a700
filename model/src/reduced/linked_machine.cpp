#include "reduced/linked_machine.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "numeric/infinity.hpp"
#include "numeric/parallel.hpp"
#include "numeric/progress.hpp"
#include "readings/readings.hpp"
#include "reduced/prepared_parts.hpp"
#include "surface/charged_readings.hpp"

namespace fringe::detail {
namespace {

using Eigen::AlignedBox3d;
using Eigen::Index;
using Eigen::Isometry3d;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Most poses in which the distances of the links are taken.
constexpr std::size_t most_poses = 50;

/// Returns the step between the poses in which distances are taken.
std::size_t stride_of(std::size_t poses) {
  return (poses + most_poses - 1) / most_poses;
}

/// Returns readings by the potentials of some of the conductors.
std::vector<ChargedReading> readings_of(const std::vector<ChargedReading>& readings,
                                        const std::vector<std::string>& names, const ChargedBodies& bodies) {
  const std::vector<std::string> own = drivable_conductors(bodies);
  std::vector<ChargedReading> result;
  for (const ChargedReading& reading : readings) {
    ChargedReading part{reading.name, VectorXd::Zero(index_of(own.size())),
                        VectorXd::Zero(index_of(own.size()))};
    for (std::size_t k = 0; k < own.size(); ++k) {
      const auto known = std::find(names.begin(), names.end(), own[k]);
      if (own[k].empty() || known == names.end())
        continue;
      part.sense[index_of(k)] = reading.sense[known - names.begin()];
      part.drive[index_of(k)] = reading.drive[known - names.begin()];
    }
    result.push_back(std::move(part));
  }
  return result;
}

/// Returns the distinct loads of readings as combinations of the conductors' unit potentials (columns), and
/// the readings by them.
std::pair<MatrixXd, std::vector<OfReading>> loads_of(const std::vector<ChargedReading>& readings,
                                                     Index conductors) {
  std::vector<VectorXd> loads;
  const auto place = [&](const VectorXd& load) {
    auto known = std::find(loads.begin(), loads.end(), load);
    if (known == loads.end())
      known = loads.insert(loads.end(), load);
    return known - loads.begin();
  };
  std::vector<OfReading> places;
  for (const ChargedReading& reading : readings) {
    const double sign = reading.sense.sum() > 0 ? 1 : -1;
    const Index sense = place(sign * reading.sense), drive = place(reading.drive);
    places.push_back({sense, drive, sign});
  }
  MatrixXd matrix(conductors, static_cast<Index>(loads.size()));
  for (std::size_t k = 0; k < loads.size(); ++k)
    matrix.col(static_cast<Index>(k)) = loads[k];
  return {matrix, places};
}

/// Returns how near targets come to a link, in its own frame.
/// @param targets boxes in the frame of the targets
Approach approach_of(const std::vector<AlignedBox3d>& targets, std::span<const PoseOfMachine> poses,
                     std::size_t link) {
  Approach result{{}, {Isometry3d::Identity()}};
  for (std::size_t k = 0; k < poses.size(); k += stride_of(poses.size()))
    for (const AlignedBox3d& box : targets)
      result.boxes.push_back({poses[k].target.inverse(Eigen::Isometry) * poses[k].links[link], box});
  return result;
}

}  // namespace

MachineResolution machine_resolution(double rtol, bool is_rough, bool has_one_link) {
  // A machine at rest has its answers tabulated, so that more functions cost a pose nothing.
  if (is_rough)
    return {{rough_rtol, 6000, 200}, {rough_rtol, 3000, 150}};
  if (has_one_link)
    return {{rtol / 2, 25000, 400, 1600}, {}};
  return {{rtol / 2, 20000, 300, 1600}, {rtol, 6000, 300, 600}};
}

LinkedMachine::LinkedMachine(std::vector<ChargedBodies> links, const std::vector<Reading>& readings,
                             std::span<const PoseOfMachine> poses, const std::vector<AlignedBox3d>& targets,
                             const MachineResolution& resolutions, std::size_t threads,
                             const PreparedFiles* files) {
  std::vector<std::string> names;
  for (const ChargedBodies& bodies : links)
    for (const std::string& name : drivable_conductors(bodies))
      if (!name.empty() && std::find(names.begin(), names.end(), name) == names.end())
        names.push_back(name);
  const std::vector<ChargedReading> charged = charged_readings(readings, names);
  const auto placed = loads_of(charged, index_of(names.size()));
  const MatrixXd& loads = placed.first;
  readings_ = placed.second;
  loads_ = loads.cols();
  for (const ChargedBodies& bodies : links) {
    charged_.push_back(readings_of(charged, names, bodies));
    used_.push_back(boxes_of_used(bodies, charged_.back()));
  }
  std::vector<std::optional<MachineLink>> made(links.size());
  parallel_for(links.size(), threads, [&](std::size_t k) {
    const std::vector<std::string> own = drivable_conductors(links[k]);
    MatrixXd potentials = MatrixXd::Zero(index_of(own.size()), loads_);
    for (std::size_t row = 0; row < own.size(); ++row)
      if (const auto known = std::find(names.begin(), names.end(), own[row]); known != names.end())
        potentials.row(index_of(row)) = loads.row(known - names.begin());
    const Approach nearness = approach(poses, k), to_targets = approach_of(targets, poses, k);
    SurfaceResolution resolution = used_[k].empty() ? resolutions.others : resolutions.used;
    resolution.threads = links.size() > 1 ? 1 : threads;
    MachineLink link;
    const ProgressPart part(links.size() == 1 ? "machine"
                                              : fmt::format("link {} of {}", k + 1, links.size()));
    const std::string input = bytes_of_bodies(links[k]) + bytes_of_readings(charged_[k]) +
                              bytes_of(potentials, nearness, to_targets, resolution);
    read_or_prepare(files, "link", input, link, [&] {
      link = MachineLink(links[k], charged_[k], potentials, nearness, to_targets, resolution);
    });
    if (k == 0)
      input_ = input;
    made[k] = std::move(link);
  });
  for (std::optional<MachineLink>& link : made)
    links_.push_back(std::move(*link));
}

std::pair<double, double> LinkedMachine::background(const OfReading& reading) const {
  const auto [sense, drive, sign] = reading;
  const MatrixXd& own = links_.front().own();
  return {sign * own(sense, drive),
          links_.front().own_error() * std::sqrt(own(sense, sense) * own(drive, drive))};
}

double stated_error(double change, const TargetAtRest& target, const ErrorsOfChange& errors) {
  /// Ratio of the stated error to the sum of its parts: measured (model/CORRECTIONS.md, section 8).
  constexpr double stated_per_parts = 2;
  /// Largest ratio of a function's radius to its distance at which its points see the gap: below, a change
  /// may be many times what is found.
  constexpr double most_nearness = 4;
  if (errors.nearness > most_nearness)
    return infinity;
  const double parts = stated_per_parts * (errors.of_others + errors.of_target +
                                           target.error_of_panels(change, errors.of_target));
  // Gaps below a function are hardly resolved; then the change may be wrong by as much as it is. The facets
  // of the machine count for the sensed and for the driven conductor.
  return std::min(parts * std::max(errors.nearness, 1.0), std::max(parts, std::abs(change))) +
         errors.of_facets + 2 * errors.of_given_facets * std::abs(change);
}

double nearness(const std::vector<PlacedBox>& used, const TargetAtRest& target, const Isometry3d& pose) {
  double nearness = 0;
  for (std::size_t function = 0; function < target.functions().count(); ++function)
    for (const PlacedBox& box : used)
      nearness =
          std::max(nearness, target.functions().radius(function) / target.distance(function, box, pose));
  return nearness;
}

double nearness(const LinkedMachine& machine, const TargetAtRest& target, const PoseOfMachine& pose) {
  double largest = 0;
  for (std::size_t link = 0; link < pose.links.size(); ++link)
    largest = std::max(largest, nearness(machine.used(link), target, pose.of_target(link)));
  return largest;
}

Approach LinkedMachine::approach(std::span<const PoseOfMachine> poses, std::size_t link) const {
  Approach result{{}, {Isometry3d::Identity()}};
  for (std::size_t k = 0; k < poses.size(); k += stride_of(poses.size()))
    for (std::size_t other = 0; other < used_.size(); ++other)
      if (other != link)
        for (const PlacedBox& box : used_[other])
          result.boxes.push_back(
              {box.to_box * (poses[k].links[other].inverse(Eigen::Isometry) * poses[k].of(link)), box.box});
  return result;
}

}  // namespace fringe::detail
