#include "correction/moving_readings.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "bem/contact.hpp"
#include "bem/readings.hpp"
#include "correction/company_parts.hpp"
#include "correction/company_readings.hpp"
#include "fringe/reading.hpp"
#include "numeric/infinity.hpp"
#include "numeric/parallel.hpp"
#include "numeric/progress.hpp"

namespace fringe::detail {
namespace {

using Eigen::AlignedBox3d;
using Eigen::Isometry3d;

/// Functions of targets: with 384, those of a person, whom sensors see from all sides, are too large for the
/// hidden ones, whose changes are then up to 8 % off, with these 3 %.
constexpr std::size_t functions_of_targets = 768;

CompanyResolution resolution_of_targets(double rtol) {
  CompanyResolution resolution = target_resolution(rtol);
  resolution.functions = functions_of_targets;
  return resolution;
}

/// Number of poses that one thread answers in turn, with the same couplings.
constexpr std::size_t poses_together = 8;

/// Returns the links of all parts of the machine.
std::vector<std::optional<std::size_t>> links_of_machine(const Scene& scene) {
  std::vector<std::optional<std::size_t>> links;
  for (const Sensor& sensor : scene.sensors)
    links.push_back(sensor.link);
  const std::vector<bool> are_targets = targets(scene);
  for (std::size_t k = 0; k < scene.objects.size(); ++k)
    if (!are_targets[k])
      links.push_back(scene.objects[k].link);
  return links;
}

/// Tells whether parts of the machine are on links that move against each other.
bool moves(const Scene& scene, const LinkMotion& motion) {
  const std::vector<std::optional<std::size_t>> links = links_of_machine(scene);
  return std::ranges::any_of(
      links, [&](std::optional<std::size_t> link) { return !motion.rigid(link, links.front()); });
}

bool are_on_several_links(const Scene& scene) {
  const std::vector<std::optional<std::size_t>> links = links_of_machine(scene);
  return std::ranges::any_of(links, [&](std::optional<std::size_t> link) { return link != links.front(); });
}

/// Tells whether poses are the same.
bool are_same_pose(const Isometry3d& a, const Isometry3d& b) {
  return a.matrix() == b.matrix();
}

}  // namespace

MovingReadings::MovingReadings(std::shared_ptr<LinkPoses> poses)
    : poses_(std::move(poses)), motion_(poses_) {}

MovingReadings::Group MovingReadings::group_of(const ChargedBodies& bodies,
                                               const std::vector<std::size_t>& members) const {
  std::vector<bool> belong(bodies.bodies.size(), false);
  for (const std::size_t k : members)
    belong[k] = true;
  ChargedBodies part = part_of(bodies, [&](std::size_t body) { return belong[body]; });
  const std::optional<std::size_t> link = part.bodies.front().link;
  const Isometry3d to_frame = motion_.world_pose(link).inverse(Eigen::Isometry);
  for (ChargedBody& body : part.bodies)
    if (body.link != link)
      body = moved(body, to_frame * motion_.world_pose(body.link));
  Group result{joined(std::move(part)), {}, link};
  for (const ChargedBody& body : result.bodies.bodies)
    result.boxes.push_back(bounds_of(body));
  return result;
}

/// Finds the groups of bodies on links that are rigid to each other. Returns false if the machine has only
/// one, the targets have more, or a conductor that floats has bodies in several.
bool MovingReadings::find_groups(const Scene& scene, const AreRigid& are_rigid) {
  const ChargedBodies bodies = bodies_on_links(scene);
  std::vector<std::vector<std::size_t>> machine, targets;
  for (std::size_t k = 0; k < bodies.bodies.size(); ++k) {
    std::vector<std::vector<std::size_t>>& groups = bodies.bodies[k].is_target ? targets : machine;
    const auto known = std::ranges::find_if(groups, [&](const std::vector<std::size_t>& group) {
      return are_rigid(bodies.bodies[group.front()].link, bodies.bodies[k].link);
    });
    if (known == groups.end())
      groups.push_back({k});
    else
      known->push_back(k);
  }
  if (machine.size() < 2 || targets.size() != 1)
    return false;
  for (std::size_t conductor = 0; conductor < bodies.conductors.size(); ++conductor)
    if (bodies.conductors[conductor].role == Role::floating &&
        std::count_if(machine.begin(), machine.end(), [&](const std::vector<std::size_t>& group) {
          return std::any_of(group.begin(), group.end(),
                             [&](std::size_t body) { return bodies.bodies[body].conductor == conductor; });
        }) > 1)
      return false;
  links_.clear();
  for (const std::vector<std::size_t>& members : machine)
    links_.push_back(group_of(bodies, members));
  target_group_ = group_of(bodies, targets.front());
  machine_.reset();
  target_.reset();
  motion_.settle();
  return true;
}

/// Tells whether there are groups, and their bodies have kept their poses to each other.
bool MovingReadings::keeps_groups() const {
  const auto keeps = [&](const Group& group) {
    return std::ranges::all_of(
        group.bodies.bodies, [&](const ChargedBody& body) { return motion_.rigid(body.link, group.frame); });
  };
  return target_group_ && std::ranges::all_of(links_, keeps) && keeps(*target_group_);
}

void MovingReadings::find_pose() {
  pose_.target = poses_->world_pose(target_group_->frame);
  pose_.links.clear();
  for (const Group& link : links_)
    pose_.links.push_back(poses_->world_pose(link.frame));
}

void MovingReadings::prepare(const Scene& scene, std::span<const PoseOfMachine> poses, double rtol,
                             std::size_t threads) {
  if (rtol_ != rtol) {
    machine_.reset();
    target_.reset();
    rtol_ = rtol;
  }
  std::vector<std::vector<Isometry3d>> of_links;
  std::vector<Isometry3d> of_target;
  for (const PoseOfMachine& pose : poses) {
    of_links.push_back(pose.links);
    of_target.push_back(pose.target);
  }
  readings_ = readings(scene);
  unit_ = unit_of(scene);
  if (!machine_) {
    std::vector<ChargedBodies> bodies;
    for (const Group& link : links_)
      bodies.push_back(link.bodies);
    machine_.emplace(std::move(bodies), readings_, of_links, target_group_->boxes, of_target, rtol, threads,
                     files_.get());
    tables_.reset();
    target_.reset();
  }
  const bool is_known =
      target_ && std::equal(poses.begin(), poses.end(), approach_.begin(), approach_.end(),
                            [](const PoseOfMachine& a, const PoseOfMachine& b) {
                              return are_same_pose(a.target, b.target) &&
                                     std::equal(a.links.begin(), a.links.end(), b.links.begin(),
                                                b.links.end(), are_same_pose);
                            });
  if (is_known)
    return;
  const Approach approach = machine_->approach(of_target, of_links, MovingMachine::none);
  const ProgressPart part("targets");
  TargetAtRest target;
  read_or_prepare(
      files_.get(), "targets",
      bytes_of_bodies(target_group_->bodies) + bytes_of(resolution_of_targets(rtol), std::optional(approach)),
      target, [&] { target = TargetAtRest(target_group_->bodies, resolution_of_targets(rtol), approach); });
  target_ = std::move(target);
  approach_.assign(poses.begin(), poses.end());
  prepared_nearness_ = 0;
  for (const PoseOfMachine& pose : poses)
    prepared_nearness_ = std::max(prepared_nearness_, MovingFormula::nearness(*machine_, *target_, pose));
  formula_ = MovingFormula();
}

/// Tabulates the links where targets and other links are in some poses.
void MovingReadings::tabulate(std::span<const PoseOfMachine> poses, std::size_t threads) {
  if (!tables_)
    tables_.emplace(*machine_, *target_);
  tables_->extend(*machine_, *target_, poses, threads);
}

/// Refuses contact between bodies of links that move against each other and may have different potentials.
void MovingReadings::refuse_contacts(const PoseOfMachine& pose) const {
  for (std::size_t a = 0; a < links_.size(); ++a)
    for (std::size_t b = a + 1; b < links_.size(); ++b) {
      const Isometry3d relative = pose.links[b].inverse(Eigen::Isometry) * pose.links[a];
      for (std::size_t first = 0; first < links_[a].boxes.size(); ++first) {
        const ChargedBody& body = links_[a].bodies.bodies[first];
        const AlignedBox3d box = moved_box(links_[a].boxes[first], relative);
        for (std::size_t second = 0; second < links_[b].boxes.size(); ++second) {
          const ChargedBody& other = links_[b].bodies.bodies[second];
          const Role role = links_[a].bodies.role(body), other_role = links_[b].bodies.role(other);
          if ((role == Role::grounded && other_role == Role::grounded) ||
              !box.intersects(links_[b].boxes[second]) ||
              links_[a].bodies.conductors[body.conductor].name ==
                  links_[b].bodies.conductors[other.conductor].name)
            continue;
          refuse_contact(moved(body, relative), other, "they may have different potentials");
        }
      }
    }
}

void MovingReadings::write_pose(MovingFormula& formula, const PoseOfMachine& pose,
                                std::vector<ReadingAnswer>& answers) const {
  answers.resize(readings_.size());
  for (std::size_t k = 0; k < answers.size(); ++k) {
    answers[k].name = readings_[k].name;
    answers[k].value = answers[k].background = answers[k].change = {};
    answers[k].derivatives.clear();
  }
  bool is_unknown = false, is_joined = false;
  for (std::size_t link = 0; link < links_.size(); ++link) {
    const TargetContacts touching =
        contacts_of(links_[link].bodies, links_[link].boxes, target_group_->bodies, target_group_->boxes,
                    pose.links[link].inverse(Eigen::Isometry) * pose.target);
    is_unknown = is_unknown || touching.is_unknown;
    is_joined = is_joined || touching.is_joined;
    for (const std::size_t conductor : touching.grounded)
      for (std::size_t k = 0; k < answers.size(); ++k) {
        const ChargedReading& reading = machine_->readings_on(link)[k];
        if (reading.sense[index_of(conductor)] != 0 || reading.drive[index_of(conductor)] != 0)
          answers[k].change = Estimate{infinity, 0};
      }
  }
  if (is_unknown) {
    for (ReadingAnswer& answer : answers)
      answer.change = {};
    return;
  }
  const std::vector<CompanyFormula::Change>& changes = formula.solved(*machine_, *tables_, *target_, pose);
  for (std::size_t k = 0; k < answers.size(); ++k)
    if (!answers[k].change.value)
      answers[k].change = estimate_of(changes[k], unit_, is_joined);
}

std::optional<std::vector<std::vector<ReadingAnswer>>>
MovingReadings::write_frames(const Scene& scene, std::size_t frames,
                             const std::function<void(std::size_t)>& pose, double rtol, std::size_t threads) {
  if (frames < 2)
    return std::nullopt;
  LinkMotion in_frames(poses_);
  std::vector<std::vector<Isometry3d>> links(frames);
  for (std::size_t frame = 0; frame < frames; ++frame) {
    pose(frame);
    in_frames.update();
    if (frame == 0)
      in_frames.settle();
    for (std::size_t link = 0; link < scene.links.size(); ++link)
      links[frame].push_back(poses_->world_pose(link));
  }
  if (!moves(scene, in_frames))
    return std::nullopt;
  motion_.update();
  // Links that are groups already stay so, if they keep their bodies' poses.
  if (!keeps_groups()) {
    const bool is_found = find_groups(scene, [&](std::optional<std::size_t> a, std::optional<std::size_t> b) {
      return in_frames.rigid(a, b);
    });
    if (!is_found)
      return std::nullopt;
  }
  std::vector<PoseOfMachine> poses;
  const auto of = [&](const Group& group, std::size_t frame) {
    return group.frame ? links[frame][*group.frame] : Isometry3d::Identity();
  };
  for (std::size_t frame = 0; frame < frames; ++frame) {
    poses.push_back({{}, of(*target_group_, frame)});
    for (const Group& link : links_)
      poses.back().links.push_back(of(link, frame));
  }
  for (const PoseOfMachine& each : poses)
    refuse_contacts(each);
  prepare(scene, poses, rtol, threads);
  tabulate(poses, threads);
  std::vector<std::vector<ReadingAnswer>> answers(frames);
  write_pose(formula_, poses.front(), answers.front());
  parallel_for((frames + poses_together - 1) / poses_together, threads, [&](std::size_t part) {
    MovingFormula formula = formula_;
    for (std::size_t k = part * poses_together; k < std::min((part + 1) * poses_together, frames); ++k)
      write_pose(formula, poses[k], answers[k]);
  });
  return answers;
}

bool MovingReadings::write(const Scene& scene, std::vector<ReadingAnswer>& answers, double rtol,
                           bool may_move) {
  motion_.update();
  if (!keeps_groups()) {
    if (!may_move || !are_on_several_links(scene))
      return false;
    // Which links will move is not known: bodies on different links are prepared by themselves.
    if (!find_groups(scene,
                     [](std::optional<std::size_t> a, std::optional<std::size_t> b) { return a == b; }))
      return false;
  }
  find_pose();
  const std::span<const PoseOfMachine> present(&pose_, 1);
  refuse_contacts(pose_);
  if (!target_ || rtol_ != rtol)
    prepare(scene, present, rtol, 1);
  tabulate(present, 1);
  write_pose(formula_, pose_, answers);
  const double nearness = MovingFormula::nearness(*machine_, *target_, pose_);
  if (is_much_nearer(nearness, prepared_nearness_) && !are_within(answers, rtol)) {
    std::vector<PoseOfMachine> approach = approach_;
    approach.push_back(pose_);
    prepare(scene, approach, rtol, 1);
    tabulate(present, 1);
    write_pose(formula_, pose_, answers);
  }
  return true;
}

void MovingReadings::write_derivatives(std::vector<ReadingAnswer>& answers) {
  if (!is_any_known(answers))
    return;
  const std::vector<MovingFormula::GroupWrenches> wrenches =
      formula_.wrenches(*machine_, *tables_, *target_, pose_);
  std::vector<PairWrench> pairs = unknown_pairs(target_group_->bodies);
  for (const Group& link : links_)
    for (const PairWrench& pair : unknown_pairs(link.bodies))
      pairs.push_back(pair);
  const std::size_t first = pairs.size();
  for (const MovingFormula::GroupWrenches& of : wrenches)
    pairs.push_back({of.first == MovingMachine::none ? target_group_->frame : links_[of.first].frame,
                     links_[of.second].frame,
                     {}});
  for (std::size_t k = 0; k < answers.size(); ++k) {
    for (std::size_t pair = 0; pair < wrenches.size(); ++pair)
      pairs[first + pair].wrench = unit_ * wrenches[pair].of_readings[k];
    detail::write_derivatives(*poses_, pairs, answers[k]);
  }
}

}  // namespace fringe::detail
