#include "correction/company_readings.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "bem/contact.hpp"
#include "bem/readings.hpp"
#include "fringe/capacitance.hpp"
#include "fringe/reading.hpp"
#include "numeric/infinity.hpp"

namespace fringe::detail {
namespace {

using Eigen::AlignedBox3d;
using Eigen::Isometry3d;
using Eigen::Vector3d;

/// Returns the error that is stated, relative to the change (model/CORRECTIONS.md, section 8): more than the
/// largest one in the open set-ups on machines, and more for gaps that the functions do not resolve.
double stated_error(double nearness) {
  return std::min(0.25 * std::sqrt(std::max(nearness, 1.0)), 1.0);
}

AlignedBox3d bounds_of(const ChargedBody& body) {
  AlignedBox3d box;
  for (const Triangle& triangle : triangulated(body.surface).triangles)
    for (const Vector3d& corner : triangle)
      box.extend(corner);
  return box;
}

AlignedBox3d moved_box(const AlignedBox3d& box, const Isometry3d& pose) {
  AlignedBox3d result;
  for (int corner = 0; corner < 8; ++corner)
    result.extend(pose * box.corner(static_cast<AlignedBox3d::CornerType>(corner)));
  return result;
}

/// Returns some of the bodies, with the conductors that these belong to.
ChargedBodies part_of(const ChargedBodies& bodies, bool of_targets) {
  ChargedBodies part;
  for (std::size_t k = 0; k < bodies.conductors.size(); ++k) {
    const auto belongs = [&](const ChargedBody& body) {
      return body.conductor == k && body.is_target == of_targets;
    };
    if (std::none_of(bodies.bodies.begin(), bodies.bodies.end(), belongs))
      continue;
    for (const ChargedBody& body : bodies.bodies)
      if (belongs(body)) {
        part.bodies.push_back(body);
        part.bodies.back().conductor = part.conductors.size();
      }
    part.conductors.push_back(bodies.conductors[k]);
  }
  return part;
}

}  // namespace

CompanyReadings::CompanyReadings(std::shared_ptr<LinkPoses> poses) : motion_(std::move(poses)) {}

CompanyReadings::Group CompanyReadings::group(const ChargedBodies& bodies, bool of_targets) const {
  ChargedBodies part = part_of(bodies, of_targets);
  const std::optional<std::size_t> link = part.bodies.front().link;
  const Isometry3d to_frame = motion_.world_pose(link).inverse(Eigen::Isometry);
  for (ChargedBody& body : part.bodies)
    if (body.link != link)
      body = moved(body, to_frame * motion_.world_pose(body.link));
  Group result{joined(std::move(part)), {}};
  for (const ChargedBody& body : result.bodies.bodies)
    result.boxes.push_back(bounds_of(body));
  return result;
}

bool CompanyReadings::has_moved(const Group& group) const {
  const std::vector<ChargedBody>& bodies = group.bodies.bodies;
  return std::any_of(bodies.begin(), bodies.end(),
                     [&](const ChargedBody& body) { return !motion_.rigid(body.link, bodies.front().link); });
}

Isometry3d CompanyReadings::frame(const Group& group) const {
  return motion_.world_pose(group.bodies.bodies.front().link);
}

void CompanyReadings::prepare(const Scene& scene) {
  motion_.update();
  if (machine_ && has_moved(*machine_group_))
    machine_.reset();
  if (target_ && has_moved(*target_group_))
    target_.reset();
  if (machine_ && target_)
    return;
  const ChargedBodies bodies = bodies_on_links(scene);
  if (!machine_) {
    machine_group_ = group(bodies, false);
    charged_readings_ = charged_readings(readings(scene), drivable_conductors(machine_group_->bodies));
    machine_.emplace(machine_group_->bodies, readings(scene));
  }
  if (!target_) {
    target_group_ = group(bodies, true);
    target_.emplace(target_group_->bodies);
  }
}

CompanyReadings::Contacts CompanyReadings::contacts(const Isometry3d& pose) const {
  Contacts found;
  for (std::size_t t = 0; t < target_group_->boxes.size(); ++t) {
    const AlignedBox3d box = moved_box(target_group_->boxes[t], pose);
    const ChargedBody& target = target_group_->bodies.bodies[t];
    const bool floats = target_group_->bodies.role(target) == Role::floating;
    for (std::size_t m = 0; m < machine_group_->boxes.size(); ++m) {
      const ChargedBody& body = machine_group_->bodies.bodies[m];
      const Role role = machine_group_->bodies.role(body);
      if ((role == Role::grounded && !floats) || !box.intersects(machine_group_->boxes[m]) ||
          !are_in_contact(moved(target, pose), body))
        continue;
      if (floats || role == Role::floating)
        found.is_unknown = true;
      else
        found.grounded.push_back(body.conductor);
    }
  }
  return found;
}

void CompanyReadings::write(const Scene& scene, std::vector<ReadingAnswer>& answers) {
  prepare(scene);
  const Isometry3d pose = frame(*machine_group_).inverse(Eigen::Isometry) * frame(*target_group_);
  motion_.settle();
  const Contacts touching = contacts(pose);
  const std::vector<double>& changes = formula_.changes(*machine_, *target_, pose);
  const double unit = 4 * std::numbers::pi * vacuum_permittivity * scene.medium.relative_permittivity;
  answers.resize(changes.size());
  for (std::size_t k = 0; k < changes.size(); ++k) {
    ReadingAnswer& answer = answers[k];
    const ChargedReading& reading = charged_readings_[k];
    answer.name = reading.name;
    answer.answered_by = name;
    answer.value = answer.background = answer.change = {};
    if (touching.is_unknown)
      continue;
    const bool is_shorted =
        std::any_of(touching.grounded.begin(), touching.grounded.end(), [&](std::size_t at) {
          const auto conductor = static_cast<Eigen::Index>(at);
          return reading.sense[conductor] != 0 || reading.drive[conductor] != 0;
        });
    answer.change = is_shorted ? Estimate{infinity, 0}
                               : Estimate{unit * changes[k],
                                          stated_error(formula_.nearness()) * std::abs(unit * changes[k])};
  }
}

}  // namespace fringe::detail
