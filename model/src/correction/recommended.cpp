#include "correction/recommended.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <string>
#include <variant>

#include "fringe/error.hpp"
#include "fringe/triangulation.hpp"

namespace fringe::detail {
namespace {

/// Largest stated error, relative to the value, with which an answer is used. Where this much is stated, the
/// mean actual error is a quarter of it, which is the rms error of the formula.
constexpr double most_stated_error = 0.1;

/// Least number of triangles of a mesh. With this many a pose takes seven times as long as the integral over
/// them, with half as many eleven times (model/CORRECTIONS.md, section 5).
constexpr std::size_t fewest_triangles = 96;

/// Tests whether a pose takes no more than ten times as long as the integral: plates and boxes, and at most
/// one body of many triangles. Two such bodies would also need the distances between their triangles.
bool is_cheap(const Scene& scene) {
  std::size_t meshes = 0;
  for (const Object& object : scene.objects) {
    // Bodies with insulators take many milliseconds for a pose.
    if (std::holds_alternative<Dielectric>(object.role))
      return false;
    if (std::holds_alternative<Plate>(object.shape) || std::holds_alternative<Cuboid>(object.shape))
      continue;
    if (++meshes > 1 || triangulate(object.shape).size() < fewest_triangles)
      return false;
  }
  return true;
}

/// Tests whether each conductor is one object, as the formula takes them.
bool conductors_are_single(const Scene& scene) {
  std::set<std::string> names;
  return std::all_of(scene.objects.begin(), scene.objects.end(), [&](const Object& object) {
    return !object.conductor || names.insert(*object.conductor).second;
  });
}

}  // namespace

RecommendedCorrection::RecommendedCorrection(const Scene& scene, std::shared_ptr<LinkPoses> poses)
    : poses_(std::move(poses)) {
  try {
    if (is_cheap(scene) && conductors_are_single(scene))
      evaluator_.emplace(scene, ReducedOptions{steps, std::nullopt, ReducedContacts::refused}, poses_);
  } catch (const InputError&) {
    // Shapes, rooms and sensors that the reduced method does not support are left to the formula, which also
    // refuses invalid input.
    evaluator_.reset();
  }
}

bool RecommendedCorrection::update() {
  if (answered_ == poses_->changes())
    return false;
  answered_ = poses_->changes();
  matrix_ = nullptr;
  if (!evaluator_)
    return true;
  try {
    matrix_ = &evaluator_->maxwell();
  } catch (const InputError&) {
    // Conductors touch. The formula accepts contacts between objects and reports a contact with a sensor.
    matrix_ = nullptr;
  }
  return true;
}

std::optional<RecommendedCorrection::Mutual> RecommendedCorrection::mutual(std::size_t sensor,
                                                                           std::size_t object) const {
  if (matrix_ == nullptr)
    return std::nullopt;
  const std::size_t conductor = matrix_->sensors + object;
  const double value = matrix_->mutual(sensor, conductor);
  const double error =
      matrix_->errors(static_cast<Eigen::Index>(sensor), static_cast<Eigen::Index>(conductor));
  if (!(error <= most_stated_error * std::abs(value)))
    return std::nullopt;
  return Mutual{value, error};
}

}  // namespace fringe::detail
