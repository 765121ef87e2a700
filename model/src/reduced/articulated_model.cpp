#include "reduced/articulated_model.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "bem/reading_derivatives.hpp"
#include "fringe/capacitance.hpp"
#include "fringe/reading.hpp"
#include "numeric/infinity.hpp"
#include "numeric/parallel.hpp"
#include "numeric/progress.hpp"
#include "surface/contact.hpp"

namespace fringe::detail {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

/// Number of threads with which a single pose is prepared: as many as this process may run at once.
constexpr std::size_t all_cores = 0;

/// Number of poses that one thread answers in turn, with the same arrays.
constexpr std::size_t poses_together = 8;

/// Returns how finely targets are prepared. Before links that move they have more functions: with 384, those
/// of a person, whom sensors see from all sides, are too large for the hidden ones, whose changes are then up
/// to 8 % off, with 768 3 %.
SurfaceResolution target_resolution(const ModelAccuracy& accuracy, bool is_before_one_link) {
  if (accuracy.is_rough)
    return {rough_rtol, 2500, is_before_one_link ? std::size_t{128} : std::size_t{256}};
  return {accuracy.rtol, 6000, is_before_one_link ? std::size_t{384} : std::size_t{768}};
}

/// Tells whether targets are so much nearer to what is sensed or driven than prepared for that they have to
/// be prepared again.
bool is_much_nearer(double nearness, double prepared) {
  /// Ratio to the prepared nearness beyond which the functions are too coarse.
  constexpr double much_nearer = 1.5;
  /// Ratio of a function's radius to its distance below which the functions are fine enough.
  constexpr double near_enough = 0.5;
  return nearness > much_nearer * std::max(prepared, near_enough);
}

/// Returns some of the bodies, given by their numbers, with the conductors that these belong to.
ChargedBodies part_of(const ChargedBodies& bodies, const std::vector<std::size_t>& members) {
  ChargedBodies part;
  for (std::size_t k = 0; k < bodies.conductors.size(); ++k) {
    bool is_part = false;
    for (const std::size_t body : members)
      if (bodies.bodies[body].conductor == k) {
        part.bodies.push_back(bodies.bodies[body]);
        part.bodies.back().conductor = part.conductors.size();
        is_part = true;
      }
    if (is_part)
      part.conductors.push_back(bodies.conductors[k]);
  }
  return part;
}

/// Tells whether each floating conductor has all its bodies in one group.
bool have_own_floating(const ChargedBodies& bodies, const std::vector<std::vector<std::size_t>>& groups) {
  std::vector<std::optional<std::size_t>> group_of(bodies.conductors.size());
  for (std::size_t group = 0; group < groups.size(); ++group)
    for (const std::size_t body : groups[group]) {
      const std::size_t conductor = bodies.bodies[body].conductor;
      if (bodies.conductors[conductor].role != Role::floating)
        continue;
      if (group_of[conductor].value_or(group) != group)
        return false;
      group_of[conductor] = group;
    }
  return true;
}

/// Returns an estimate in F. Its error is unknown where none is stated.
Estimate estimate_of(double value, double error, double unit) {
  if (!std::isfinite(value))
    return {};
  return {unit * value, std::isfinite(error) ? std::optional(unit * error) : std::nullopt};
}

/// Returns pairs of links whose bodies are prepared together, so that what they contribute to derivatives is
/// not known.
void add_unknown_pairs(const ChargedBodies& bodies, std::vector<PairWrench>& pairs) {
  const Vector3d unknown = Vector3d::Constant(std::numeric_limits<double>::quiet_NaN());
  const std::optional<std::size_t> first = bodies.bodies.front().link;
  for (const ChargedBody& body : bodies.bodies)
    if (body.link != first)
      pairs.push_back({body.link, first, {unknown, unknown}});
}

/// Returns a ball around a group, in the world.
BodyBall ball_around(const RigidGroup& group, const LinkPoses& poses) {
  Eigen::AlignedBox3d box;
  for (const Eigen::AlignedBox3d& own : group.boxes)
    box.extend(own);
  return {poses.world_pose(group.frame) * box.center(), box.diagonal().norm() / 2};
}

}  // namespace

bool are_within(const std::vector<ReadingAnswer>& answers, double rtol) {
  return std::ranges::all_of(answers, [&](const ReadingAnswer& reading) {
    return reading.change.error && *reading.change.error <= rtol * std::abs(*reading.change.value);
  });
}

ArticulatedModel::ArticulatedModel(std::shared_ptr<LinkPoses> poses)
    : poses_(std::move(poses)), motion_(poses_) {}

RigidGroup ArticulatedModel::group_of(const ChargedBodies& bodies, const Members& members) const {
  ChargedBodies part = part_of(bodies, members);
  const std::optional<std::size_t> link = part.bodies.front().link;
  const Isometry3d to_frame = motion_.world_pose(link).inverse(Eigen::Isometry);
  for (ChargedBody& body : part.bodies)
    if (body.link != link)
      body = moved(body, to_frame * motion_.world_pose(body.link));
  RigidGroup result{joined(std::move(part)), {}, link};
  for (const ChargedBody& body : result.bodies.bodies)
    result.boxes.push_back(bounds_of(body));
  return result;
}

bool ArticulatedModel::keeps(const RigidGroup& group, const LinkMotion& motion) {
  return std::ranges::all_of(group.bodies.bodies,
                             [&](const ChargedBody& body) { return motion.rigid(body.link, group.frame); });
}

/// Tells whether the machine has groups, and these keep together.
bool ArticulatedModel::links_keep(const LinkMotion& motion) const {
  return !links_.empty() &&
         std::ranges::all_of(links_, [&](const RigidGroup& group) { return keeps(group, motion); });
}

/// Groups bodies of the machine that are rigid to each other. The whole machine is one group if a floating
/// conductor would have bodies in several.
void ArticulatedModel::find_links(const Scene& scene, const AreRigid& are_rigid) {
  const ChargedBodies bodies = bodies_on_links(scene);
  std::vector<Members> groups;
  Members machine;
  for (std::size_t k = 0; k < bodies.bodies.size(); ++k) {
    if (bodies.bodies[k].is_target)
      continue;
    machine.push_back(k);
    const auto known = std::ranges::find_if(groups, [&](const Members& group) {
      return are_rigid(bodies.bodies[group.front()].link, bodies.bodies[k].link);
    });
    if (known == groups.end())
      groups.push_back({k});
    else
      known->push_back(k);
  }
  if (!have_own_floating(bodies, groups))
    groups = {machine};
  links_.clear();
  for (const Members& members : groups)
    links_.push_back(group_of(bodies, members));
  machine_.reset();
  motion_.settle();
}

void ArticulatedModel::find_targets(const Scene& scene) {
  const ChargedBodies bodies = bodies_on_links(scene);
  Members targets;
  for (std::size_t k = 0; k < bodies.bodies.size(); ++k)
    if (bodies.bodies[k].is_target)
      targets.push_back(k);
  targets_ = group_of(bodies, targets);
  target_.reset();
  motion_.settle();
}

void ArticulatedModel::find_pose(PoseOfMachine& pose) const {
  pose.target = motion_.world_pose(targets_->frame);
  pose.links.clear();
  for (const RigidGroup& link : links_)
    pose.links.push_back(motion_.world_pose(link.frame));
}

/// Ends the preparation for another accuracy.
void ArticulatedModel::ask(const ModelAccuracy& accuracy) {
  if (accuracy_ != accuracy)
    machine_.reset();
  accuracy_ = accuracy;
}

/// Prepares what is not prepared, the targets for an approach in these poses.
void ArticulatedModel::prepare(const Scene& scene, std::span<const PoseOfMachine> poses,
                               std::size_t threads) {
  if (!machine_) {
    target_.reset();
    readings_ = readings(scene);
    unit_ = 4 * std::numbers::pi * vacuum_permittivity * scene.medium.relative_permittivity;
    prepare_machine(poses, threads);
  }
  prepare_targets(poses);
}

void ArticulatedModel::prepare_machine(std::span<const PoseOfMachine> poses, std::size_t threads) {
  std::vector<ChargedBodies> bodies;
  for (const RigidGroup& link : links_)
    bodies.push_back(link.bodies);
  // A machine at rest is prepared for targets wherever they go.
  machine_ = std::make_unique<const LinkedMachine>(
      std::move(bodies), readings_, is_at_rest() ? std::span<const PoseOfMachine>() : poses,
      is_at_rest() ? std::vector<Eigen::AlignedBox3d>() : targets_->boxes,
      machine_resolution(accuracy_->rtol, accuracy_->is_rough, is_at_rest()), threads, files_.get());
  tabulated_.reset();
  tables_.reset();
}

void ArticulatedModel::prepare_targets(std::span<const PoseOfMachine> poses) {
  const auto are_same = [](const PoseOfMachine& a, const PoseOfMachine& b) {
    return are_equal(a.target, b.target) &&
           std::equal(a.links.begin(), a.links.end(), b.links.begin(), b.links.end(),
                      [](const Isometry3d& one, const Isometry3d& other) { return are_equal(one, other); });
  };
  if (target_ && std::equal(poses.begin(), poses.end(), approach_.begin(), approach_.end(), are_same))
    return;
  const Approach approach = machine_->approach(poses, LinkedMachine::none);
  const SurfaceResolution resolution = target_resolution(*accuracy_, is_at_rest());
  const ProgressPart part("targets");
  target_input_ = bytes_of_bodies(targets_->bodies) + bytes_of(resolution, approach);
  auto target = std::make_unique<TargetAtRest>();
  read_or_prepare(files_.get(), "targets", target_input_, *target,
                  [&] { *target = TargetAtRest(targets_->bodies, resolution, approach); });
  target_ = std::move(target);
  approach_.assign(poses.begin(), poses.end());
  prepared_nearness_ = 0;
  for (const PoseOfMachine& pose : poses)
    prepared_nearness_ = std::max(prepared_nearness_, nearness(*machine_, *target_, pose));
  solvers_ = Solvers();
}

/// Tabulates the machine where targets and other links are in some poses.
void ArticulatedModel::tabulate(std::span<const PoseOfMachine> poses, std::size_t threads) {
  const ProgressPart part("tables");
  if (!is_at_rest()) {
    if (!tables_)
      tables_ = std::make_unique<LinkTables>(*machine_, *target_);
    tables_->extend(*machine_, *target_, poses, threads);
    return;
  }
  of_target_.clear();
  for (const PoseOfMachine& pose : poses)
    of_target_.push_back(pose.of_target(0));
  if (tabulated_) {
    tabulated_->extend(*target_, of_target_, threads);
    return;
  }
  // Only these poses' tables are kept in files: cells that later poses add depend on all poses before them.
  auto tabulated = std::make_unique<TabulatedMachine>(*machine_, *target_);
  read_or_prepare(files_.get(), "tables", machine_->input() + target_input_ + bytes_of(of_target_),
                  *tabulated, [&] { tabulated->extend(*target_, of_target_, threads); });
  tabulated_ = std::move(tabulated);
}

/// Finds where the targets touch each link.
void ArticulatedModel::find_contacts(const PoseOfMachine& pose, std::vector<TargetContacts>& touching) const {
  touching.clear();
  for (std::size_t link = 0; link < links_.size(); ++link)
    touching.push_back(contacts_of(links_[link], *targets_, pose.of_target(link)));
}

/// Tells whether contact grounds what a reading senses or drives.
bool ArticulatedModel::is_shorted(std::size_t reading, const std::vector<TargetContacts>& touching) const {
  for (std::size_t link = 0; link < links_.size(); ++link) {
    const ChargedReading& charged = machine_->readings_on(link)[reading];
    for (const std::size_t conductor : touching[link].grounded)
      if (charged.sense[index_of(conductor)] != 0 || charged.drive[index_of(conductor)] != 0)
        return true;
  }
  return false;
}

/// Tells whether contact leaves a change to be computed.
bool ArticulatedModel::needs_solution(const std::vector<TargetContacts>& touching) const {
  if (std::ranges::any_of(touching, &TargetContacts::is_unknown))
    return false;
  for (std::size_t reading = 0; reading < readings_.size(); ++reading)
    if (!is_shorted(reading, touching))
      return true;
  return false;
}

const std::vector<SolvedReading>& ArticulatedModel::solved(Solvers& solvers,
                                                           const PoseOfMachine& pose) const {
  return is_at_rest() ? solvers.at_rest.solved(*tabulated_, *target_, pose.of_target(0), accuracy_->rtol)
                      : solvers.moving.solved(*machine_, *tables_, *target_, pose);
}

void ArticulatedModel::write_pose(Solvers& solvers, const PoseOfMachine& pose,
                                  const std::vector<TargetContacts>& touching,
                                  std::vector<ReadingAnswer>& answers) const {
  answers.resize(readings_.size());
  for (std::size_t k = 0; k < answers.size(); ++k) {
    answers[k].name = readings_[k].name;
    answers[k].value = answers[k].background = answers[k].change = {};
    answers[k].derivatives.clear();
  }
  if (std::ranges::any_of(touching, &TargetContacts::is_unknown))
    return;
  for (std::size_t k = 0; k < answers.size(); ++k) {
    if (!is_shorted(k, touching))
      continue;
    answers[k].change = Estimate{infinity, 0};
    if (is_at_rest()) {
      const auto [background, error] = machine_->background(machine_->readings()[k]);
      answers[k].background = estimate_of(background, error, unit_);
    }
  }
  if (!needs_solution(touching))
    return;
  const bool is_joined = std::ranges::any_of(touching, &TargetContacts::is_joined);
  const std::vector<SolvedReading>& found = solved(solvers, pose);
  for (std::size_t k = 0; k < found.size(); ++k) {
    if (answers[k].change.value)
      continue;
    const auto& [change, error, background, background_error] = found[k];
    // Where targets are joined to the machine, their charges lie in its own: then the change may be wrong by
    // as much as it is.
    answers[k].change = estimate_of(change, is_joined ? std::max(error, std::abs(change)) : error, unit_);
    answers[k].background = estimate_of(background, background_error, unit_);
    if (!answers[k].change.value || !answers[k].background.value)
      continue;
    answers[k].value.value = *answers[k].background.value + *answers[k].change.value;
    if (answers[k].change.error && answers[k].background.error)
      answers[k].value.error = *answers[k].background.error + *answers[k].change.error;
  }
}

void ArticulatedModel::write(const Scene& scene, std::vector<ReadingAnswer>& answers,
                             const ModelAccuracy& accuracy, bool with_derivatives) {
  motion_.update();
  const bool is_to_divide = with_derivatives && !is_divided_ && is_at_rest() &&
                            std::ranges::any_of(links_.front().bodies.bodies, [&](const ChargedBody& body) {
                              return body.link != links_.front().frame;
                            });
  // Finding groups forgets all moves, so that both are asked first.
  const bool links_stay = !is_to_divide && links_keep(motion_),
             targets_stay = targets_ && keeps(*targets_, motion_);
  if (!links_stay) {
    // Which links will move is not known: once some have, or derivatives are asked for, bodies on different
    // links are prepared by themselves.
    is_divided_ = with_derivatives || !links_.empty();
    find_links(scene, [&](std::optional<std::size_t> a, std::optional<std::size_t> b) {
      return !is_divided_ || a == b;
    });
  }
  if (!targets_stay)
    find_targets(scene);
  ask(accuracy);
  find_pose(pose_);
  const std::span<const PoseOfMachine> present(&pose_, 1);
  refuse_contacts_of_links(pose_);
  if (!machine_ || !target_)
    prepare(scene, present, all_cores);
  find_contacts(pose_, touching_);
  // In contact the readings need no tables, and around a contact a table would need the smallest cells.
  if (needs_solution(touching_))
    tabulate(present, all_cores);
  write_pose(solvers_, pose_, touching_, answers);
  if (!needs_solution(touching_) || are_within(answers, accuracy.rtol) ||
      !is_much_nearer(nearness(*machine_, *target_, pose_), prepared_nearness_))
    return;
  std::vector<PoseOfMachine> approach = approach_;
  approach.push_back(pose_);
  prepare(scene, approach, all_cores);
  tabulate(present, all_cores);
  write_pose(solvers_, pose_, touching_, answers);
}

/// Refuses contact between links whose potentials may differ.
void ArticulatedModel::refuse_contacts_of_links(const PoseOfMachine& pose) const {
  for (std::size_t a = 0; a < links_.size(); ++a)
    for (std::size_t b = a + 1; b < links_.size(); ++b)
      refuse_contacts(links_[a], links_[b], pose.links[b].inverse(Eigen::Isometry) * pose.links[a]);
}

void ArticulatedModel::write_derivatives(std::vector<ReadingAnswer>& answers) {
  if (std::ranges::none_of(answers, [](const ReadingAnswer& answer) {
        return answer.change.value && std::isfinite(*answer.change.value);
      }))
    return;
  std::vector<GroupWrenches> wrenches;
  if (is_at_rest()) {
    wrenches.push_back(
        {LinkedMachine::none, 0, solvers_.at_rest.wrenches(*tabulated_, *target_, pose_.of_target(0))});
    for (Wrench& wrench : wrenches.front().of_readings)
      wrench = in_outer_frame(wrench, pose_.links.front());
  } else {
    wrenches = solvers_.moving.wrenches(*machine_, *tables_, *target_, pose_);
  }
  std::vector<PairWrench> pairs;
  add_unknown_pairs(targets_->bodies, pairs);
  for (const RigidGroup& link : links_)
    add_unknown_pairs(link.bodies, pairs);
  const std::size_t first = pairs.size();
  for (const GroupWrenches& of : wrenches) {
    const RigidGroup &first_group = of.first == LinkedMachine::none ? *targets_ : links_[of.first],
                     &second_group = links_[of.second];
    const BodyBall one = ball_around(first_group, *poses_), other = ball_around(second_group, *poses_);
    pairs.push_back({first_group.frame, second_group.frame, {}, one.radius < other.radius ? one : other});
  }
  for (std::size_t k = 0; k < answers.size(); ++k) {
    for (std::size_t pair = 0; pair < wrenches.size(); ++pair)
      pairs[first + pair].wrench = unit_ * wrenches[pair].of_readings[k];
    write_link_derivatives(*poses_, pairs, answers[k]);
  }
}

/// Answers poses in which all groups keep together.
void ArticulatedModel::answer(const Scene& scene, std::span<const PoseOfMachine> poses, std::size_t threads,
                              std::span<std::vector<ReadingAnswer>> answers) {
  if (poses.empty())
    return;
  for (const PoseOfMachine& pose : poses)
    refuse_contacts_of_links(pose);
  prepare(scene, poses, threads);
  std::vector<std::vector<TargetContacts>> touching(poses.size());
  std::vector<PoseOfMachine> clear;
  for (std::size_t k = 0; k < poses.size(); ++k) {
    find_contacts(poses[k], touching[k]);
    if (needs_solution(touching[k]))
      clear.push_back(poses[k]);
  }
  if (!clear.empty())
    tabulate(clear, threads);
  // Links that keep their poses to each other have the couplings of the first pose in all others.
  if (!is_at_rest())
    write_pose(solvers_, poses.front(), touching.front(), answers.front());
  parallel_for((poses.size() + poses_together - 1) / poses_together, threads, [&](std::size_t part) {
    Solvers solvers{{}, solvers_.moving};
    for (std::size_t k = part * poses_together; k < std::min((part + 1) * poses_together, poses.size()); ++k)
      write_pose(solvers, poses[k], touching[k], answers[k]);
  });
}

std::vector<std::vector<ReadingAnswer>>
ArticulatedModel::write_frames(const Scene& scene, std::size_t frames,
                               const std::function<void(std::size_t)>& pose, const ModelAccuracy& accuracy,
                               std::size_t threads) {
  // Which bodies keep their poses in all frames, to each other.
  LinkMotion in_frames(poses_);
  for (std::size_t frame = 0; frame < frames; ++frame) {
    pose(frame);
    in_frames.update();
    if (frame == 0)
      in_frames.settle();
  }
  std::vector<std::vector<ReadingAnswer>> answers(frames);
  std::vector<PoseOfMachine> poses;
  const auto answer_all = [&](std::size_t end) {
    answer(scene, poses, threads, std::span(answers).subspan(end - poses.size(), poses.size()));
    poses.clear();
  };
  for (std::size_t frame = 0; frame < frames; ++frame) {
    pose(frame);
    motion_.update();
    const bool links_stay = links_keep(motion_) && (frame > 0 || links_keep(in_frames)),
               targets_stay = targets_ && keeps(*targets_, motion_);
    if (!links_stay || !targets_stay)
      answer_all(frame);
    if (!links_stay) {
      is_divided_ = false;
      find_links(scene, std::bind_front(&LinkMotion::rigid, &in_frames));
    }
    if (!targets_stay)
      find_targets(scene);
    if (frame == 0)
      ask(accuracy);
    find_pose(poses.emplace_back());
  }
  answer_all(frames);
  return answers;
}

}  // namespace fringe::detail
