#include "surface/target_contacts.hpp"

#include "surface/contact.hpp"
#include "surface/placed_box.hpp"

namespace fringe::detail {

using Eigen::AlignedBox3d;
using Eigen::Isometry3d;

TargetContacts contacts_of(const RigidGroup& machine, const RigidGroup& targets, const Isometry3d& pose) {
  TargetContacts found;
  for (std::size_t t = 0; t < targets.boxes.size(); ++t) {
    const AlignedBox3d box = moved_box(targets.boxes[t], pose);
    const ChargedBody& target = targets.bodies.bodies[t];
    const bool floats = targets.bodies.role(target) == Role::floating;
    for (std::size_t m = 0; m < machine.boxes.size(); ++m) {
      const ChargedBody& body = machine.bodies.bodies[m];
      const Role role = machine.bodies.role(body);
      if (!box.intersects(machine.boxes[m]) || !are_in_contact(moved(target, pose), body))
        continue;
      if (floats || role == Role::floating)
        found.is_unknown = true;
      else if (role == Role::grounded)
        found.is_joined = true;
      else
        found.grounded.push_back(body.conductor);
    }
  }
  return found;
}

void refuse_contacts(const RigidGroup& first, const RigidGroup& second, const Isometry3d& pose) {
  for (std::size_t a = 0; a < first.boxes.size(); ++a) {
    const ChargedBody& body = first.bodies.bodies[a];
    const AlignedBox3d box = moved_box(first.boxes[a], pose);
    for (std::size_t b = 0; b < second.boxes.size(); ++b) {
      const ChargedBody& other = second.bodies.bodies[b];
      if ((first.bodies.role(body) == Role::grounded && second.bodies.role(other) == Role::grounded) ||
          !box.intersects(second.boxes[b]) ||
          first.bodies.conductors[body.conductor].name == second.bodies.conductors[other.conductor].name)
        continue;
      refuse_contact(moved(body, pose), other, "they may have different potentials");
    }
  }
}

}  // namespace fringe::detail
