#include "reduced/machine_readings.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>
#include <utility>
#include <variant>

#include "formula/layer_rule.hpp"
#include "fringe/reading.hpp"

namespace fringe::detail {
namespace {

/// Returns the polarisability of a ball over that of a conducting one; `ratio` is its permittivity over the
/// medium's.
double share_of_conductor(double ratio) {
  return (ratio - 1) / (ratio + 2);
}

/// Error of a change by the layer rule in the place of covers, relative to it: in the 100 set-ups with covers
/// and films of Experiment VIII changes are 1.8 % off rms and 4.5 % at worst (model/CORRECTIONS.md, section
/// 9).
constexpr double layer_rule_error = 0.06;

/// Returns the scene with conductors in the place of dielectric targets; those that float are one conductor.
Scene with_conductors(Scene scene, const std::vector<bool>& enclosed, const ElectricalRole& role) {
  std::optional<std::string> conductor;
  for (std::size_t k = 0; k < scene.objects.size(); ++k) {
    if (!enclosed[k])
      continue;
    Object& object = scene.objects[k];
    if (!conductor)
      conductor = object.name;
    object.role = role;
    if (std::holds_alternative<Floating>(role))
      object.conductor = conductor;
  }
  return without_covers(scene, CoveredPlate::doubled);
}

/// Returns the scene without the dielectric targets. The others are marked: none of the rest becomes one.
Scene without_enclosed(Scene scene, const std::vector<bool>& enclosed) {
  const std::vector<bool> are_targets = targets(scene);
  std::vector<Object> kept;
  for (std::size_t k = 0; k < scene.objects.size(); ++k)
    if (!enclosed[k]) {
      kept.push_back(std::move(scene.objects[k]));
      kept.back().target = are_targets[k];
    }
  scene.objects = std::move(kept);
  return without_covers(scene, CoveredPlate::doubled);
}

bool is_known(const ReadingAnswer& answer) {
  return answer.change.value && std::isfinite(*answer.change.value);
}

}  // namespace

std::vector<bool> are_enclosed(const Scene& scene) {
  const std::vector<bool> are_targets = targets(scene);
  const bool asks = asks_for_changes(scene);
  std::vector<bool> result;
  for (std::size_t k = 0; k < scene.objects.size(); ++k) {
    const auto* dielectric = std::get_if<Dielectric>(&scene.objects[k].role);
    result.push_back(asks && dielectric != nullptr && are_targets[k] &&
                     dielectric->relative_permittivity >= scene.medium.relative_permittivity);
  }
  return result;
}

MachineReadings::MachineReadings(std::shared_ptr<LinkPoses> poses) : poses_(std::move(poses)) {}

bool MachineReadings::knows(const Scene& scene) {
  const std::vector<bool> enclosed = are_enclosed(scene), are_targets = targets(scene);
  for (std::size_t k = 0; k < scene.objects.size(); ++k)
    if (std::holds_alternative<Dielectric>(scene.objects[k].role) && !enclosed[k] &&
        !is_cover(scene.objects[k]))
      return false;
  return !readings(scene).empty() && !scene.has_room &&
         std::find(are_targets.begin(), are_targets.end(), true) != are_targets.end();
}

void MachineReadings::prepare(const Scene& scene) {
  if (upper_)
    return;
  has_insulators_ = std::ranges::any_of(
      scene.objects, [](const Object& object) { return std::holds_alternative<Dielectric>(object.role); });
  has_covers_ = std::ranges::any_of(scene.objects, is_cover);
  const std::vector<bool> enclosed = are_enclosed(scene);
  for (std::size_t k = 0; k < scene.objects.size(); ++k)
    if (enclosed[k])
      share_ = std::max(share_.value_or(0),
                        share_of_conductor(std::get<Dielectric>(scene.objects[k].role).relative_permittivity /
                                           scene.medium.relative_permittivity));
  for (const Reading& reading : readings(scene))
    drive_themselves_.push_back(reading.drive == std::vector<std::string>{reading.sense});
  if (!share_) {
    upper_.emplace(Conducting{without_covers(scene, CoveredPlate::doubled), ArticulatedModel(poses_)});
    return;
  }
  Conducting grounded{with_conductors(scene, enclosed, Grounded{}), ArticulatedModel(poses_)};
  Scene without = without_enclosed(scene, enclosed);
  if (std::ranges::any_of(without.objects, &Object::target)) {
    // Beside other targets, which they may touch, they are grounded at once.
    lower_.emplace(Conducting{std::move(without), ArticulatedModel(poses_)});
    upper_.emplace(std::move(grounded));
  } else {
    grounded_.emplace(std::move(grounded));
    upper_.emplace(Conducting{with_conductors(scene, enclosed, Floating{}), ArticulatedModel(poses_)});
  }
}

void MachineReadings::write(const Scene& scene, std::vector<ReadingAnswer>& answers,
                            const ModelAccuracy& accuracy, bool with_derivatives) {
  prepare(scene);
  upper_->model.keep_in(files_);
  upper_->model.write(upper_->scene, answers, accuracy, with_derivatives);
  if (has_insulators_)
    // Covers and dielectric targets are not there, so that only changes are known.
    for (ReadingAnswer& answer : answers)
      answer.value = answer.background = {};
  if (share_)
    enclose(answers, accuracy);
  if (has_covers_)
    for (ReadingAnswer& answer : answers)
      if (answer.change.error && std::isfinite(*answer.change.value))
        *answer.change.error += layer_rule_error * std::abs(*answer.change.value);
}

void MachineReadings::write_derivatives(std::vector<ReadingAnswer>& answers) {
  if (!share_)
    upper_->model.write_derivatives(answers);
}

std::vector<std::vector<ReadingAnswer>>
MachineReadings::write_frames(const Scene& scene, std::size_t frames,
                              const std::function<void(std::size_t)>& pose, const ModelAccuracy& accuracy,
                              std::size_t threads) {
  prepare(scene);
  upper_->model.keep_in(files_);
  if (!has_insulators_)
    return upper_->model.write_frames(upper_->scene, frames, pose, accuracy, threads);
  std::vector<std::vector<ReadingAnswer>> answers(frames);
  for (std::size_t k = 0; k < frames; ++k) {
    pose(k);
    write(scene, answers[k], accuracy);
  }
  return answers;
}

/// Replaces the changes with conductors in the place of dielectric targets by what these make.
void MachineReadings::enclose(std::vector<ReadingAnswer>& answers, const ModelAccuracy& accuracy) {
  if (grounded_ && std::ranges::any_of(answers, std::not_fn(is_known))) {
    std::vector<ReadingAnswer> grounded;
    grounded_->model.write(grounded_->scene, grounded, accuracy);
    for (std::size_t k = 0; k < answers.size(); ++k)
      if (!is_known(answers[k]))
        answers[k].change = grounded[k].change;
  }
  std::vector<ReadingAnswer> lowest;
  if (lower_)
    lower_->model.write(lower_->scene, lowest, accuracy);
  for (std::size_t k = 0; k < answers.size(); ++k) {
    Estimate& change = answers[k].change;
    const Estimate lower = lower_ ? lowest[k].change : Estimate{0, 0};
    if (lower.value && std::isinf(*lower.value)) {
      // Another target shorts the reading.
      change = lower;
      continue;
    }
    if (!is_known(answers[k]) || !lower.value) {
      // A conductor in contact with what is sensed or driven is no upper bound.
      change = {};
      continue;
    }
    const double range = *change.value - *lower.value, value = *lower.value + *share_ * range;
    // Between two conductors the change may have either sign.
    const double below = drive_themselves_[k] ? *share_ * range : range;
    const double above = drive_themselves_[k] ? range - *share_ * range : range;
    const bool is_estimated = lower.error && change.error;
    change = {value, is_estimated ? std::optional(std::max(std::abs(below) + *lower.error,
                                                           std::abs(above) + *change.error))
                                  : std::nullopt};
  }
}

}  // namespace fringe::detail
