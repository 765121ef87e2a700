#include "correction/company_readings.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <span>
#include <utility>

#include "bem/contact.hpp"
#include "bem/readings.hpp"
#include "correction/company_parts.hpp"
#include "fringe/capacitance.hpp"
#include "fringe/reading.hpp"
#include "geometry/wrench.hpp"
#include "numeric/infinity.hpp"
#include "numeric/parallel.hpp"
#include "numeric/progress.hpp"

namespace fringe::detail {
namespace {

using Eigen::AlignedBox3d;
using Eigen::Isometry3d;
using Eigen::Vector3d;

/// Returns how finely the machine is prepared for an accuracy.
CompanyResolution machine_resolution(std::optional<double> rtol, std::size_t threads) {
  return rtol ? CompanyResolution{*rtol / 2, 25000, 400, 1600, threads, true} : MachineAtRest::usual;
}

}  // namespace

CompanyResolution target_resolution(std::optional<double> rtol) {
  return rtol ? CompanyResolution{*rtol, 6000, 384} : TargetAtRest::usual;
}

bool is_much_nearer(double nearness, double prepared) {
  /// Ratio to the prepared nearness beyond which the functions are too coarse.
  constexpr double much_nearer = 1.5;
  /// Ratio of a function's radius to its distance below which the functions are fine enough.
  constexpr double near_enough = 0.5;
  return nearness > much_nearer * std::max(prepared, near_enough);
}

AlignedBox3d bounds_of(const ChargedBody& body) {
  AlignedBox3d box;
  for (const Triangle& triangle : triangulated(body.surface).triangles)
    for (const Vector3d& corner : triangle)
      box.extend(corner);
  return box;
}

ChargedBodies part_of(const ChargedBodies& bodies, const std::function<bool(std::size_t)>& belongs) {
  ChargedBodies part;
  for (std::size_t k = 0; k < bodies.conductors.size(); ++k) {
    bool is_part = false;
    for (std::size_t body = 0; body < bodies.bodies.size(); ++body)
      if (bodies.bodies[body].conductor == k && belongs(body)) {
        part.bodies.push_back(bodies.bodies[body]);
        part.bodies.back().conductor = part.conductors.size();
        is_part = true;
      }
    if (is_part)
      part.conductors.push_back(bodies.conductors[k]);
  }
  return part;
}

double unit_of(const Scene& scene) {
  return 4 * std::numbers::pi * vacuum_permittivity * scene.medium.relative_permittivity;
}

bool are_within(const std::vector<ReadingAnswer>& answers, double rtol) {
  return std::ranges::all_of(answers, [&](const ReadingAnswer& reading) {
    return reading.change.error && *reading.change.error <= rtol * std::abs(*reading.change.value);
  });
}

Estimate estimate_of(const CompanyFormula::Change& change, double unit, bool is_joined) {
  if (!std::isfinite(change.value))
    return {};
  Estimate estimate{unit * change.value};
  if (std::isfinite(change.error))
    estimate.error = unit * std::max(change.error, is_joined ? std::abs(change.value) : 0);
  return estimate;
}

bool is_any_known(const std::vector<ReadingAnswer>& answers) {
  return std::ranges::any_of(answers, [](const ReadingAnswer& answer) {
    return answer.change.value && std::isfinite(*answer.change.value);
  });
}

std::vector<PairWrench> unknown_pairs(const ChargedBodies& bodies) {
  const Vector3d unknown = Vector3d::Constant(std::numeric_limits<double>::quiet_NaN());
  const std::optional<std::size_t> first = bodies.bodies.front().link;
  std::vector<PairWrench> pairs;
  for (const ChargedBody& body : bodies.bodies)
    if (body.link != first)
      pairs.push_back({body.link, first, {unknown, unknown}});
  return pairs;
}

void write_derivatives(const LinkPoses& poses, std::span<const PairWrench> pairs, ReadingAnswer& answer) {
  /// Ratio of the relative errors of derivatives and changes, that of boundary elements.
  constexpr double error_per_error = 10;
  answer.derivatives.clear();
  // In contact there are none; and of a change that may be anything nothing is known.
  if (!answer.change.value || std::isinf(*answer.change.value) || !answer.change.error)
    return;
  answer.derivatives = derivatives_by_link(poses, pairs);
  const double relative = error_per_error * *answer.change.error / std::abs(*answer.change.value);
  for (LinkDerivatives& of_link : answer.derivatives) {
    PoseDerivatives& error = of_link.error.emplace();
    error << Vector3d::Constant(relative * of_link.change.head<3>().norm()),
        Vector3d::Constant(relative * of_link.change.tail<3>().norm());
  }
}

CompanyReadings::CompanyReadings(std::shared_ptr<LinkPoses> poses)
    : poses_(std::move(poses)), motion_(poses_), moving_(poses_) {}

CompanyReadings::Group CompanyReadings::group(const ChargedBodies& bodies, bool of_targets) const {
  ChargedBodies part =
      part_of(bodies, [&](std::size_t body) { return bodies.bodies[body].is_target == of_targets; });
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

void CompanyReadings::update(std::optional<double> rtol) {
  motion_.update();
  if (machine_group_ && has_moved(*machine_group_)) {
    machine_group_.reset();
    machine_.reset();
  }
  if (target_group_ && has_moved(*target_group_)) {
    target_group_.reset();
    target_.reset();
  }
  if (rtol != rtol_) {
    machine_.reset();
    target_.reset();
    rtol_ = rtol;
  }
  // An approach is to what is sensed or driven, which has moved.
  if (!machine_ && rtol_)
    target_.reset();
}

void CompanyReadings::find_groups(const Scene& scene) {
  if (machine_group_ && target_group_)
    return;
  const ChargedBodies bodies = bodies_on_links(scene);
  if (!machine_group_)
    machine_group_ = group(bodies, false);
  if (!target_group_)
    target_group_ = group(bodies, true);
}

void CompanyReadings::prepare(const Scene& scene, const std::vector<Isometry3d>& poses, std::size_t threads) {
  if (!machine_) {
    charged_readings_ = charged_readings(readings(scene), drivable_conductors(machine_group_->bodies));
    const ProgressPart part("machine");
    const CompanyResolution resolution = machine_resolution(rtol_, threads);
    machine_input_ =
        bytes_of_bodies(machine_group_->bodies) + bytes_of_readings(readings(scene)) + bytes_of(resolution);
    auto machine = std::make_unique<MachineAtRest>();
    read_or_prepare(files(), "machine", machine_input_, *machine,
                    [&] { *machine = MachineAtRest(machine_group_->bodies, readings(scene), resolution); });
    machine_ = std::move(machine);
    tabulated_.reset();
  }
  if (target_)
    return;
  std::optional<Approach> approach;
  if (rtol_)
    approach = {machine_->used(), poses};
  const ProgressPart part("targets");
  target_input_ = bytes_of_bodies(target_group_->bodies) + bytes_of(target_resolution(rtol_), approach);
  TargetAtRest target;
  read_or_prepare(files(), "targets", target_input_, target,
                  [&] { target = TargetAtRest(target_group_->bodies, target_resolution(rtol_), approach); });
  target_ = std::move(target);
  approach_ = poses;
  prepared_nearness_ = 0;
  for (const Isometry3d& pose : poses)
    prepared_nearness_ = std::max(prepared_nearness_, CompanyFormula::nearness(*machine_, *target_, pose));
}

void CompanyReadings::tabulate(std::span<const Isometry3d> poses, std::size_t threads) {
  if (!rtol_)
    return;
  const ProgressPart part("tables");
  if (tabulated_) {
    tabulated_->extend(*target_, poses, threads);
    return;
  }
  // Only these poses' tables are kept in files: cells that later poses add depend on all poses before them.
  auto tabulated = std::make_unique<TabulatedMachine>(*machine_, *target_);
  read_or_prepare(files(), "tables",
                  machine_input_ + target_input_ +
                      bytes_of(std::vector<Isometry3d>(poses.begin(), poses.end())),
                  *tabulated, [&] { tabulated->extend(*target_, poses, threads); });
  tabulated_ = std::move(tabulated);
}

TargetContacts contacts_of(const ChargedBodies& machine, const std::vector<AlignedBox3d>& machine_boxes,
                           const ChargedBodies& targets, const std::vector<AlignedBox3d>& target_boxes,
                           const Isometry3d& pose) {
  TargetContacts found;
  for (std::size_t t = 0; t < target_boxes.size(); ++t) {
    const AlignedBox3d box = moved_box(target_boxes[t], pose);
    const ChargedBody& target = targets.bodies[t];
    const bool floats = targets.role(target) == Role::floating;
    for (std::size_t m = 0; m < machine_boxes.size(); ++m) {
      const ChargedBody& body = machine.bodies[m];
      const Role role = machine.role(body);
      if (!box.intersects(machine_boxes[m]) || !are_in_contact(moved(target, pose), body))
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

TargetContacts CompanyReadings::contacts(const Isometry3d& pose) const {
  return contacts_of(machine_group_->bodies, machine_group_->boxes, target_group_->bodies,
                     target_group_->boxes, pose);
}

bool CompanyReadings::is_shorted(const ChargedReading& reading, const TargetContacts& touching) {
  return std::ranges::any_of(touching.grounded, [&](std::size_t conductor) {
    const auto at = static_cast<Eigen::Index>(conductor);
    return reading.sense[at] != 0 || reading.drive[at] != 0;
  });
}

bool CompanyReadings::needs_formula(const TargetContacts& touching) const {
  return !touching.is_unknown && !std::ranges::all_of(charged_readings_, [&](const ChargedReading& reading) {
    return is_shorted(reading, touching);
  });
}

void CompanyReadings::write_pose(CompanyFormula& formula, TabulatedFormula* tabulated, const Isometry3d& pose,
                                 const TargetContacts& touching, std::vector<ReadingAnswer>& answers) const {
  answers.resize(charged_readings_.size());
  for (std::size_t k = 0; k < answers.size(); ++k) {
    answers[k].name = charged_readings_[k].name;
    answers[k].value = answers[k].background = answers[k].change = {};
    answers[k].derivatives.clear();
  }
  if (touching.is_unknown)
    return;
  for (std::size_t k = 0; k < answers.size(); ++k)
    if (is_shorted(charged_readings_[k], touching))
      answers[k].change = Estimate{infinity, 0};
  if (!needs_formula(touching))
    return;
  const std::vector<CompanyFormula::Change>& changes =
      tabulated != nullptr ? tabulated->solved(*tabulated_, *target_, pose, *rtol_)
                           : formula.changes(*machine_, *target_, pose);
  for (std::size_t k = 0; k < changes.size(); ++k) {
    if (answers[k].change.value)
      continue;
    const auto& [background, error] = machine_->backgrounds()[k];
    Estimate& change = answers[k].change = estimate_of(changes[k], unit_, touching.is_joined);
    answers[k].background = {unit_ * background, unit_ * error};
    if (!change.value)
      continue;
    answers[k].value.value = *answers[k].background.value + *change.value;
    if (change.error)
      answers[k].value.error = *answers[k].background.error + *change.error;
  }
}

void CompanyReadings::write(const Scene& scene, std::vector<ReadingAnswer>& answers,
                            std::optional<double> rtol, bool with_derivatives) {
  motion_.update();
  is_by_links_ = rtol && moving_.write(scene, answers, *rtol,
                                       with_derivatives || (machine_ && has_moved(*machine_group_)));
  if (is_by_links_)
    return;
  update(rtol);
  find_groups(scene);
  const Isometry3d pose = target_pose();
  if (!machine_ || !target_)
    prepare(scene, {pose}, 1);
  motion_.settle();
  unit_ = unit_of(scene);
  TabulatedFormula* const tabulated = rtol ? &tabulated_formula_ : nullptr;
  const TargetContacts touching = contacts(pose);
  // What contact decides needs no tables, which would be fine everywhere.
  if (needs_formula(touching))
    tabulate(std::span(&pose, 1), 1);
  write_pose(formula_, tabulated, pose, touching, answers);
  if (!rtol || !needs_formula(touching) ||
      !is_much_nearer(CompanyFormula::nearness(*machine_, *target_, pose), prepared_nearness_) ||
      are_within(answers, *rtol))
    return;
  approach_.push_back(pose);
  target_.reset();
  prepare(scene, std::vector<Isometry3d>(approach_), 1);
  tabulate(std::span(&pose, 1), 1);
  write_pose(formula_, tabulated, pose, touching, answers);
}

void CompanyReadings::write_derivatives(std::vector<ReadingAnswer>& answers) {
  if (is_by_links_) {
    moving_.write_derivatives(answers);
    return;
  }
  if (!is_any_known(answers))
    return;
  const std::vector<Wrench>& wrenches = tabulated_formula_.wrenches(*tabulated_, *target_, target_pose());
  const Isometry3d to_world = frame(*machine_group_);
  std::vector<PairWrench> pairs = unknown_pairs(machine_group_->bodies);
  for (const PairWrench& pair : unknown_pairs(target_group_->bodies))
    pairs.push_back(pair);
  pairs.push_back(
      {target_group_->bodies.bodies.front().link, machine_group_->bodies.bodies.front().link, {}});
  for (std::size_t k = 0; k < answers.size(); ++k) {
    pairs.back().wrench = unit_ * in_outer_frame(wrenches[k], to_world);
    detail::write_derivatives(*poses_, pairs, answers[k]);
  }
}

std::vector<std::vector<ReadingAnswer>>
CompanyReadings::write_frames(const Scene& scene, std::size_t frames,
                              const std::function<void(std::size_t)>& pose, std::optional<double> rtol,
                              std::size_t threads) {
  /// Number of poses that one thread answers in turn, with the same arrays.
  constexpr std::size_t together = 8;
  if (rtol)
    if (auto moving = moving_.write_frames(scene, frames, pose, *rtol, threads))
      return *std::move(moving);
  unit_ = unit_of(scene);
  std::vector<std::vector<ReadingAnswer>> answers(frames);
  std::vector<Isometry3d> poses;
  const auto answer_all = [&](std::size_t end) {
    if (poses.empty())
      return;
    if (approach_.size() != poses.size() ||
        !std::equal(poses.begin(), poses.end(), approach_.begin(),
                    [](const Isometry3d& a, const Isometry3d& b) { return a.matrix() == b.matrix(); }))
      target_.reset();
    prepare(scene, poses, threads);
    std::vector<TargetContacts> touching;
    std::vector<Isometry3d> clear;
    for (const Isometry3d& each : poses) {
      touching.push_back(contacts(each));
      if (needs_formula(touching.back()))
        clear.push_back(each);
    }
    if (!clear.empty())
      tabulate(clear, threads);
    const std::size_t first = end - poses.size();
    parallel_for((poses.size() + together - 1) / together, threads, [&](std::size_t part) {
      CompanyFormula formula;
      TabulatedFormula tabulated;
      for (std::size_t k = part * together; k < std::min((part + 1) * together, poses.size()); ++k)
        write_pose(formula, rtol ? &tabulated : nullptr, poses[k], touching[k], answers[first + k]);
    });
    poses.clear();
  };
  for (std::size_t k = 0; k < frames; ++k) {
    pose(k);
    motion_.update();
    if ((machine_group_ && has_moved(*machine_group_)) || (target_group_ && has_moved(*target_group_)))
      answer_all(k);
    update(rtol);
    find_groups(scene);
    motion_.settle();
    poses.push_back(target_pose());
  }
  answer_all(frames);
  return answers;
}

}  // namespace fringe::detail
