#include "correction/moving_machine.hpp"

#include <algorithm>
#include <functional>
#include <optional>
#include <string>
#include <utility>

#include "bem/readings.hpp"
#include "correction/company_parts.hpp"
#include "correction/prepared_parts.hpp"
#include "numeric/parallel.hpp"
#include "numeric/progress.hpp"

namespace fringe::detail {
namespace {

using Eigen::AlignedBox3d;
using Eigen::Index;
using Eigen::Isometry3d;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Size of a part of a link relative to its distance from what is sensed or driven, below which it is not
/// divided: measured on the machines of model/CORRECTIONS.md, section 8.
constexpr double fine_enough = 0.5;

/// Most poses in which the distances of the links are taken.
constexpr std::size_t most_poses = 50;

/// Returns the size of a part relative to its distance from what is sensed or driven.
double size_of(const AlignedBox3d& part, const std::vector<PlacedBox>& used, const Approach& approach) {
  return std::max(relative_size(part, used), approach.relative_size(part));
}

/// Returns the step between the poses in which distances are taken.
std::size_t stride_of(std::size_t poses) {
  return (poses + most_poses - 1) / most_poses;
}

/// Returns how finely a link is prepared.
CompanyResolution resolution_of(bool is_used, double rtol, std::size_t threads) {
  return is_used ? CompanyResolution{rtol / 2, 20000, 300, 1600, threads}
                 : CompanyResolution{rtol, 6000, 300, 600, threads};
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

/// Marks the conductors whose charges have to be accurate; all if the readings use none of them.
void ask(ChargedBodies& bodies, const std::vector<ChargedReading>& readings) {
  bool is_any_asked = false;
  for (std::size_t k = 0; k < bodies.conductors.size(); ++k) {
    const Index at = index_of(k);
    bodies.conductors[k].is_asked = bodies.conductors[k].role == Role::floating ||
                                    std::ranges::any_of(readings, [&](const ChargedReading& reading) {
                                      return reading.sense[at] != 0 || reading.drive[at] != 0;
                                    });
    is_any_asked = is_any_asked || bodies.conductors[k].is_asked;
  }
  if (!is_any_asked)
    for (ChargedConductor& conductor : bodies.conductors)
      conductor.is_asked = true;
}

/// Returns the given charges of the panels: those of the loads that the bodies carry, and what these lack
/// with one density on each group of panels.
MatrixXd given_charges(const ConductorsAtRest& conductors, const MatrixXd& loads,
                       const std::vector<Index>& carried) {
  const MatrixXd all = potentials(conductors.matrix(), conductors.bodies());
  const MatrixXd potentials_of_loads = all * loads(Eigen::seqN(0, all.cols()), carried);
  MatrixXd given(conductors.charges().rows(), 2 * index_of(carried.size()));
  given << conductors.charges() * potentials_of_loads,
      (conductors.charges() - conductors.coarse_charges()) * potentials_of_loads;
  return given;
}

/// Returns how near targets come to a body, in its own frame.
/// @param targets boxes in the frame of the targets
/// @param of_targets the poses of this frame
/// @param frames the poses of the body's frame
Approach approach_of(const std::vector<AlignedBox3d>& targets, const std::vector<Isometry3d>& of_targets,
                     const std::vector<Isometry3d>& frames) {
  Approach result{{}, {Isometry3d::Identity()}};
  for (std::size_t pose = 0; pose < frames.size(); pose += stride_of(frames.size()))
    for (const AlignedBox3d& box : targets)
      result.boxes.push_back({of_targets[pose].inverse(Eigen::Isometry) * frames[pose], box});
  return result;
}

std::vector<Index> carried_by(const MatrixXd& loads) {
  std::vector<Index> carried;
  for (Index load = 0; load < loads.cols(); ++load)
    if (!loads.col(load).isZero(0))
      carried.push_back(load);
  return carried;
}

}  // namespace

MachineLink::MachineLink(ChargedBodies bodies, const std::vector<ChargedReading>& readings,
                         const MatrixXd& loads, const Approach& approach, const Approach& to_targets,
                         const CompanyResolution& resolution)
    : MachineLink(
          [&] {
            ask(bodies, readings);
            const std::vector<PlacedBox> used = boxes_of_used(bodies, readings);
            return ConductorsAtRest(
                std::move(bodies), resolution.rtol, resolution.most_panels, resolution.least_panels,
                resolution.threads,
                [&, used](const AlignedBox3d& box) { return size_of(box, used, approach); });
          }(),
          readings, loads, approach, to_targets, resolution) {}

MachineLink::MachineLink(const ConductorsAtRest& conductors, const std::vector<ChargedReading>& readings,
                         const MatrixXd& loads, const Approach& approach, const Approach& to_targets,
                         const CompanyResolution& resolution)
    : loads_(carried_by(loads)), excess_(conductors.error() / resolution.rtol), functions_([&] {
        const std::vector<PlacedBox> used = boxes_of_used(conductors.bodies(), readings);
        const MatrixXd given = given_charges(conductors, loads, loads_);
        const auto importance = [&](const ChargeFunctions::Part& part) {
          const double size = size_of(part.box, used, approach);
          return size > fine_enough ? size * to_targets.relative_size(part.box) : 0;
        };
        ChargeFunctions functions(conductors, given, importance, resolution.functions);
        // Where fewer are fine enough, the sums of neighbours have to be half as many as these.
        return functions.count() < resolution.functions
                   ? ChargeFunctions(conductors, given, importance, functions.count())
                   : functions;
      }()),
      net_(net_on_floating(functions_, conductors.bodies()).cast<float>()),
      to_ground_(to_ground_of(conductors.bodies())),
      coarse_(functions_, net_on_floating(functions_, conductors.bodies()), to_ground_),
      energies_(functions_.energies().cast<float>()) {}

MovingMachine::MovingMachine(std::vector<ChargedBodies> links, const std::vector<Reading>& readings,
                             const std::vector<std::vector<Isometry3d>>& poses,
                             const std::vector<AlignedBox3d>& targets,
                             const std::vector<Isometry3d>& of_targets, double rtol, std::size_t threads,
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
    std::vector<Isometry3d> frames;
    frames.reserve(poses.size());
    for (const std::vector<Isometry3d>& pose : poses)
      frames.push_back(pose[k]);
    const Approach nearness = approach(frames, poses, k),
                   to_targets = approach_of(targets, of_targets, frames);
    const CompanyResolution resolution = resolution_of(!used_[k].empty(), rtol, 1);
    MachineLink link;
    const ProgressPart part("link " + std::to_string(k + 1) + " of " + std::to_string(links.size()));
    read_or_prepare(files, "link",
                    bytes_of_bodies(links[k]) + bytes_of_readings(charged_[k]) +
                        bytes_of(potentials, nearness, to_targets, resolution),
                    link, [&] {
                      link = MachineLink(links[k], charged_[k], potentials, nearness, to_targets, resolution);
                    });
    made[k] = std::move(link);
  });
  for (std::optional<MachineLink>& link : made)
    links_.push_back(std::move(*link));
}

Approach MovingMachine::approach(const std::vector<Isometry3d>& frames,
                                 const std::vector<std::vector<Isometry3d>>& poses,
                                 std::size_t skipped) const {
  Approach result{{}, {Isometry3d::Identity()}};
  for (std::size_t pose = 0; pose < poses.size(); pose += stride_of(poses.size()))
    for (std::size_t link = 0; link < used_.size(); ++link)
      if (link != skipped)
        for (const PlacedBox& box : used_[link])
          result.boxes.push_back(
              {box.to_box * (poses[pose][link].inverse(Eigen::Isometry) * frames[pose]), box.box});
  return result;
}

}  // namespace fringe::detail
