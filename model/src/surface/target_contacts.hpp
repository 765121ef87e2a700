#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include <Eigen/Geometry>

#include "surface/bodies.hpp"

namespace fringe::detail {

/// Bodies that keep their poses to each other, in the frame of the first one's link.
struct RigidGroup {
  ChargedBodies bodies;
  std::vector<Eigen::AlignedBox3d> boxes;  ///< of every body
  std::optional<std::size_t> frame;        ///< the link in whose frame they are
};

/// Where targets touch bodies of a machine: the conductors of these that they ground, whether a contact
/// joins other potentials, and whether grounded targets touch what is grounded.
struct TargetContacts {
  std::vector<std::size_t> grounded;
  bool is_unknown = false;
  bool is_joined = false;
};

/// Finds the contacts of targets with bodies of a machine.
/// @param pose from the frame of the targets to that of the machine
TargetContacts contacts_of(const RigidGroup& machine, const RigidGroup& targets,
                           const Eigen::Isometry3d& pose);

/// Refuses contact between two groups of a machine whose potentials may differ.
/// @param pose from the frame of the first to that of the second
/// @throws InputError with both names.
void refuse_contacts(const RigidGroup& first, const RigidGroup& second, const Eigen::Isometry3d& pose);

}  // namespace fringe::detail
