#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include <Eigen/Geometry>

#include "bem/bodies.hpp"
#include "correction/charge_functions.hpp"
#include "correction/company.hpp"
#include "fringe/reading_answer.hpp"
#include "fringe/scene.hpp"
#include "geometry/link_motion.hpp"
#include "geometry/wrench.hpp"

/// Parts of the preparation of machines for its readings, at rest or with links that move
/// (model/CORRECTIONS.md, section 8).
namespace fringe::detail {

/// Returns the capacitances to the ground of the conductors that float, in m.
Eigen::VectorXd to_ground_of(const ChargedBodies& bodies);

/// Returns the net charges of functions on the conductors that float (columns).
Eigen::MatrixXd net_on_floating(const ChargeFunctions& functions, const ChargedBodies& bodies);

/// Returns boxes around the sensed and driven bodies.
std::vector<PlacedBox> boxes_of_used(const ChargedBodies& bodies,
                                     const std::vector<ChargedReading>& readings);

/// Returns the size of a part of the machine relative to its distance from what is sensed and driven.
double relative_size(const Eigen::AlignedBox3d& part, const std::vector<PlacedBox>& used);

/// Returns the distinct loads of readings as combinations of the conductors' unit potentials (columns), and
/// the readings by them.
std::pair<Eigen::MatrixXd, std::vector<MachineAtRest::OfReading>>
loads_of(const std::vector<ChargedReading>& readings, Eigen::Index conductors);

/// Returns how finely the targets are prepared for an accuracy.
CompanyResolution target_resolution(std::optional<double> rtol);

/// Tells whether a target is so much nearer to what is sensed or driven than prepared for that it has to be
/// prepared again. Nearness is the largest ratio of a function's radius to its distance.
bool is_much_nearer(double nearness, double prepared);

/// Returns the box around a body.
Eigen::AlignedBox3d bounds_of(const ChargedBody& body);

/// Returns some of the bodies, given by their places, with the conductors that these belong to.
ChargedBodies part_of(const ChargedBodies& bodies, const std::function<bool(std::size_t)>& belongs);

/// Returns 4πε of a scene's medium, F/m.
double unit_of(const Scene& scene);

/// Where targets touch bodies of a machine: the conductors of these that they ground, whether a contact
/// joins other potentials, and whether grounded targets touch what is grounded.
struct TargetContacts {
  std::vector<std::size_t> grounded;
  bool is_unknown = false;
  bool is_joined = false;
};

/// Finds the contacts of targets with bodies of a machine. Every body has its box.
/// @param pose from the frame of the targets to that of the machine
TargetContacts contacts_of(const ChargedBodies& machine,
                           const std::vector<Eigen::AlignedBox3d>& machine_boxes,
                           const ChargedBodies& targets, const std::vector<Eigen::AlignedBox3d>& target_boxes,
                           const Eigen::Isometry3d& pose);

/// Returns a change in F; `unit` is 4πε. Its error is unknown where none is stated. Where targets are joined
/// to the machine, their charges lie in its own: then it may be wrong by as much as it is.
Estimate estimate_of(const CompanyFormula::Change& change, double unit, bool is_joined);

/// Tells whether a change of the readings is known and finite: then its derivatives may be known.
bool is_any_known(const std::vector<ReadingAnswer>& answers);

/// Returns pairs of links whose bodies are prepared together, so that what they contribute to derivatives is
/// not known.
std::vector<PairWrench> unknown_pairs(const ChargedBodies& bodies);

/// Writes the derivatives of a change that is known and finite, and their errors.
/// @param pairs what the pairs of links contribute
void write_derivatives(const LinkPoses& poses, std::span<const PairWrench> pairs, ReadingAnswer& answer);

}  // namespace fringe::detail
