#include "reduced/arrangement.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <ranges>
#include <utility>

#include <fmt/format.h>

#include "fringe/error.hpp"
#include "fringe/reading.hpp"
#include "reduced/body_gap.hpp"
#include "surface/insulators.hpp"

namespace fringe::detail {
namespace {

using Eigen::Isometry3d;

/// Returns the connected components of bodies in contact, ordered by their first bodies.
std::vector<std::vector<std::size_t>> components(std::size_t bodies, const std::vector<Contact>& contacts) {
  std::vector<std::size_t> first(bodies);
  std::iota(first.begin(), first.end(), std::size_t{0});
  for (const auto& [a, b] : contacts) {
    const auto [kept, other] = std::minmax({first[a], first[b]});
    std::replace(first.begin(), first.end(), std::size_t{other}, std::size_t{kept});
  }
  std::vector<std::vector<std::size_t>> all(bodies);
  for (std::size_t body = 0; body < bodies; ++body)
    all[first[body]].push_back(body);
  std::erase_if(all, [](const std::vector<std::size_t>& component) { return component.empty(); });
  return all;
}

/// Moves groups of targets alone behind all others. Returns the number of those that are not targets, or none
/// if a group has bodies of both kinds.
std::optional<std::size_t> targets_last(std::vector<BodyGroup>& groups, const ChargedBodies& bodies,
                                        const std::vector<LinkedInsulator>& insulators) {
  const auto is_target = [&](std::size_t body) { return bodies.bodies[body].is_target; };
  const auto comes = [&](std::size_t insulator) { return insulators[insulator].body.is_target; };
  const auto targets = std::stable_partition(groups.begin(), groups.end(), [&](const BodyGroup& group) {
    return std::ranges::none_of(group.parts, is_target) && std::ranges::none_of(group.insulators, comes);
  });
  const bool are_separate = std::all_of(targets, groups.end(), [&](const BodyGroup& group) {
    return std::ranges::all_of(group.parts, is_target) && std::ranges::all_of(group.insulators, comes);
  });
  if (!are_separate)
    return std::nullopt;
  return static_cast<std::size_t>(targets - groups.begin());
}

}  // namespace

Arrangement::Arrangement(const Scene& scene, ReducedContacts contacts, double accuracy,
                         std::shared_ptr<LinkPoses> poses)
    : allowed_(contacts), accuracy_(accuracy), motion_(std::move(poses)),
      objects_(ordered_objects(without_insulators(scene))),
      on_links_(bodies_on_links(without_insulators(scene))), insulators_(insulators_on_links(scene)) {
  const std::vector<bool> are_targets = targets(scene);
  for (ChargedBody& body : on_links_.bodies)
    for (std::size_t k = 0; k < scene.objects.size(); ++k)
      if (scene.objects[k].name == on_links_.conductors[body.conductor].members[body.member])
        body.is_target = are_targets[k];
  refuse_thick_covers(scene);
  join();
}

void Arrangement::update() {
  motion_.update();
  if (joins_hold() && place())
    return;
  join();
  place();
}

void Arrangement::settle() {
  motion_.settle();
  is_settled_ = true;
}

/// Returns the pose that takes a part from its link's frame to that of another body.
Isometry3d Arrangement::relative_pose(std::size_t part, std::size_t first) const {
  const auto own = on_links_.bodies[part].link, other = on_links_.bodies[first].link;
  return own == other ? Isometry3d::Identity()
                      : motion_.world_pose(other).inverse() * motion_.world_pose(own);
}

bool Arrangement::may_join(std::size_t a, std::size_t b) const {
  if (allowed_ == ReducedContacts::refused || !have_one_potential(on_links_, a, b))
    return false;
  return allowed_ == ReducedContacts::all || on_links_.bodies[a].link == on_links_.bodies[b].link;
}

ChargedBody Arrangement::in_world(std::size_t body) const {
  return moved(on_links_.bodies[body], motion_.world_pose(on_links_.bodies[body].link));
}

/// Returns the contacts between bodies that may be joined.
std::vector<Contact> Arrangement::contacts() const {
  if (allowed_ == ReducedContacts::refused)
    return {};
  ChargedBodies world{on_links_.conductors, {}};
  for (std::size_t body = 0; body < on_links_.bodies.size(); ++body)
    world.bodies.push_back(in_world(body));
  std::vector<Contact> result = contacts_at_one_potential(world);
  std::erase_if(result, [&](const Contact& contact) { return !may_join(contact[0], contact[1]); });
  return result;
}

/// Returns true if the parts of all bodies have the relative poses with which they were joined.
bool Arrangement::joins_hold() const {
  for (std::size_t body = 0; body < rigid_.size(); ++body) {
    const std::vector<std::size_t>& parts = rigid_[body].parts;
    for (std::size_t k = 1; k < parts.size(); ++k)
      if (!are_equal(relative_pose(parts[k], parts[0]), joined_at_[body][k], unit_ * rigid_[body].scale))
        return false;
  }
  return true;
}

/// Joins the bodies that are in contact at the current poses.
void Arrangement::join() {
  const std::vector<Contact> found = contacts();
  ChargedBodies bodies = joined(on_links_, found);
  std::vector<BodyGroup> groups = this->groups(found);
  const std::optional<std::size_t> machine_bodies = targets_last(groups, bodies, insulators_);
  std::vector<std::vector<Isometry3d>> poses;
  std::vector<Insulator> insulators;
  insulators.reserve(insulators_.size());
  for (const LinkedInsulator& insulator : insulators_)
    insulators.push_back(insulator.body);
  for (const BodyGroup& group : groups) {
    poses.emplace_back();
    for (const std::size_t part : group.parts) {
      poses.back().push_back(relative_pose(part, group.parts.front()));
      if (on_links_.bodies[part].link != on_links_.bodies[group.parts.front()].link)
        bodies.bodies[part] = moved(bodies.bodies[part], poses.back().back());
    }
    for (const std::size_t insulator : group.insulators)
      if (const auto link = group.parts.empty() ? insulators_[group.insulators.front()].link
                                                : on_links_.bodies[group.parts.front()].link;
          insulators_[insulator].link != link)
        insulators[insulator] =
            moved(insulators[insulator],
                  motion_.world_pose(link).inverse() * motion_.world_pose(insulators_[insulator].link));
  }
  std::vector<RigidBody> rigid = rigid_bodies(objects_, bodies, insulators, groups, accuracy_, shapes_);
  shapes_.forget_others(rigid);
  double largest = 0;
  for (const RigidBody& body : rigid)
    largest = std::max(largest, body.scale);
  // A power of two: scaling by it does not round.
  unit_ = std::exp2(std::ilogb(largest));
  for (RigidBody& body : rigid)
    body.scale /= unit_;
  bodies_ = std::move(bodies);
  for (ChargedConductor& conductor : bodies_.conductors)
    conductor.to_ground /= unit_;
  rigid_ = std::move(rigid);
  machine_bodies_ = machine_bodies;
  joined_at_ = std::move(poses);
  placed_.resize(rigid_.size());
  gaps_.resize(rigid_.size() * rigid_.size());
  smoothness_.resize(rigid_.size() * rigid_.size());
  is_settled_ = false;
  ++joinings_;
}

/// Moves the bodies to their poses. Returns false if some of them have to be joined; throws InputError for
/// contact between bodies that may not be joined.
bool Arrangement::place() {
  /// Gap in units of unit_ above which bodies are apart in spite of rounding; below it the exact test
  /// decides.
  constexpr double surely_apart = 1e-8;
  for (std::size_t k = 0; k < rigid_.size(); ++k) {
    const Isometry3d pose = motion_.world_pose(link(k)) * rigid_[k].on_link;
    if (!pose.matrix().allFinite())
      throw InputError(
          fmt::format("{}: its pose is not finite", rigid_[k].parts.empty()
                                                        ? insulators_[rigid_[k].insulators.front()].body.name
                                                        : on_links_.bodies[rigid_[k].parts.front()].name));
    placed_[k] = {rigid_[k].shape, rigid_[k].scale, pose.translation() / unit_, pose.linear()};
  }
  for (std::size_t a = 0; a < rigid_.size(); ++a)
    for (std::size_t b = a + 1; b < rigid_.size(); ++b) {
      if (!has_moved(a, b))
        continue;
      double gap = body_gap(placed_[a], placed_[b]);
      if (!(gap > surely_apart)) {
        if (must_be_joined(a, b))
          return false;
        gap = std::max(gap, 0.0);
      }
      gaps_[pair(a, b)] = gaps_[pair(b, a)] = gap;
      const PairSmoothness smoothness = detail::smoothness(placed_[a], placed_[b], gap);
      smoothness_[pair(a, b)] = smoothness.a;
      smoothness_[pair(b, a)] = smoothness.b;
    }
  return true;
}

/// Returns true if parts of two rigid bodies are in contact and may be joined; throws InputError if they may
/// not be.
bool Arrangement::must_be_joined(std::size_t a, std::size_t b) const {
  for (const std::size_t part : rigid_[a].parts)
    for (const std::size_t other : rigid_[b].parts) {
      const ChargedBody one = in_world(part), two = in_world(other);
      if (!have_one_potential(on_links_, part, other)) {
        refuse_contact(one, two, "they may have different potentials");
      } else if (are_in_contact(one, two)) {
        if (may_join(part, other))
          return true;
        throw InputError(
            fmt::format("{} and {} touch: they would have to be joined for every pose", one.name, two.name));
      }
    }
  refuse_contact_of_insulators(a, b);
  return false;
}

ChargedBody Arrangement::insulator_in_world(std::size_t insulator) const {
  const LinkedInsulator& one = insulators_[insulator];
  return surface_of(moved(one.body, motion_.world_pose(one.link)));
}

/// Throws InputError if dielectric bodies of a rigid body touch another one.
void Arrangement::refuse_contact_of_insulators(std::size_t a, std::size_t b) const {
  const auto refuse = [&](std::size_t insulator, const ChargedBody& other) {
    const ChargedBody one = insulator_in_world(insulator);
    if (are_in_contact(one, other))
      throw InputError(
          fmt::format("{} and {} touch: the reduced method takes dielectric bodies only with a conductor on "
                      "their link; boundary-elements takes them",
                      one.name, other.name));
  };
  for (const auto& [own, other] : {std::pair(a, b), std::pair(b, a)})
    for (const std::size_t insulator : rigid_[own].insulators) {
      for (const std::size_t part : rigid_[other].parts)
        refuse(insulator, in_world(part));
      for (const std::size_t second : rigid_[other].insulators)
        refuse(insulator, insulator_in_world(second));
    }
}

/// Returns the groups of bodies in contact, and with each the dielectric bodies on the same link that touch
/// it. Throws InputError for a dielectric body that touches several.
std::vector<BodyGroup> Arrangement::groups(const std::vector<Contact>& contacts) const {
  std::vector<BodyGroup> result;
  for (std::vector<std::size_t>& parts : components(on_links_.bodies.size(), contacts))
    result.push_back({std::move(parts), {}});
  const std::size_t conductors = result.size();
  std::vector<ChargedBody> surfaces;
  for (std::size_t k = 0; k < insulators_.size(); ++k)
    surfaces.push_back(insulator_in_world(k));
  const auto touches = [&](std::size_t insulator, const BodyGroup& group) {
    return std::ranges::any_of(group.parts,
                               [&](std::size_t part) {
                                 return on_links_.bodies[part].link == insulators_[insulator].link &&
                                        are_in_contact(surfaces[insulator], in_world(part));
                               }) ||
           std::ranges::any_of(group.insulators, [&](std::size_t other) {
             return insulators_[other].link == insulators_[insulator].link &&
                    are_in_contact(surfaces[insulator], surfaces[other]);
           });
  };
  for (std::size_t k = 0; k < insulators_.size(); ++k) {
    std::vector<std::size_t> touched;
    for (std::size_t g = 0; g < result.size(); ++g)
      if (touches(k, result[g]))
        touched.push_back(g);
    if (touched.empty()) {
      result.push_back({{}, {k}});
      continue;
    }
    if (touched.size() > 1 && touched[1] < conductors)
      throw InputError(
          fmt::format("{} touches {} and {}, which are no single conductor in contact: the reduced method "
                      "prepares a dielectric body with one; boundary-elements takes it",
                      insulators_[k].body.name, on_links_.bodies[result[touched[0]].parts.front()].name,
                      on_links_.bodies[result[touched[1]].parts.front()].name));
    BodyGroup& first = result[touched.front()];
    first.insulators.push_back(k);
    for (std::size_t g = touched.size(); g-- > 1;) {
      const auto& others = result[touched[g]].insulators;
      first.insulators.insert(first.insulators.end(), others.begin(), others.end());
      result.erase(result.begin() + static_cast<std::ptrdiff_t>(touched[g]));
    }
    std::sort(first.insulators.begin(), first.insulators.end());
  }
  return result;
}

bool Arrangement::covers_sensors() const {
  return std::ranges::any_of(rigid_, [&](const RigidBody& body) {
    return !body.insulators.empty() && !body.parts.empty() &&
           on_links_.role(on_links_.bodies[body.parts.front()]) == Role::sensor;
  });
}

}  // namespace fringe::detail
