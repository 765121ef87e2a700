#include "fringe/boundary_elements.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "bem/conductor_problem.hpp"
#include "bem/insulated_maxwell.hpp"
#include "bem/mesh_size.hpp"
#include "fringe/error.hpp"
#include "fringe/interruption.hpp"
#include "readings/asked_error.hpp"
#include "readings/readings.hpp"
#include "surface/bodies.hpp"
#include "surface/insulators.hpp"
#include "surface/simplification.hpp"

namespace fringe {
namespace {

using detail::ChargedBodies;
using detail::refined_maxwell;
using detail::RefinedMaxwell;
using detail::Role;
using detail::Simplification;
using Eigen::Index;
using Eigen::VectorXd;

constexpr double strictest_rtol = 1e-6;
constexpr double loosest_rtol = 0.5;

/// Ratio of the tolerance of simplified surfaces to rtol. The surfaces move by a fraction of the tolerance on
/// average, and only a part of the charge is where it counts.
constexpr double simplification_part = 3;

/// Ratio of that tolerance to the next one, if the surfaces cost too much, and how many are tried.
constexpr double simplified_less = 4;

/// How much more of its shape a small part of a conductor may lose, at the first attempt. With more, nine
/// robot arms without dielectric bodies became no faster. Of the one whose surfaces cost too much, small
/// parts were the reason.
constexpr double simplified_part = 4;
constexpr int most_attempts = 3;

/// The triangles of all bodies are at most one in so many of the allowed unknowns: the others are for
/// refinement.
constexpr std::size_t most_triangles_part = 2;

/// Solves with functions on faces, or with triangles in place of faces whose functions would miss another
/// body close by: two spaces that both miss a feature agree. Retries with triangles in place of faces for
/// which the most functions were too few. Gives up as refined_maxwell() does.
std::optional<MaxwellMatrix> solve_as_needed(const Simplification& simplification, bool may_give_up,
                                             const BoundaryElementOptions& options,
                                             const detail::LinkPoses* poses) {
  const ChargedBodies& bodies = simplification.bodies();
  const auto others = detail::with_triangles_by_proximity(bodies);
  std::optional<RefinedMaxwell> answer =
      refined_maxwell(others ? *others : bodies, simplification, may_give_up, options, poses);
  if (!answer)
    return std::nullopt;
  /// Relative error up to which panels in place of many functions would take long to gain anything.
  constexpr double good = 1e-3;
  if (detail::largest_error(answer->matrix, bodies) <= std::max(good, options.rtol))
    return std::move(answer->matrix);
  try {
    if (const auto more = detail::with_triangles(others ? *others : bodies, answer->needs_panels))
      if (std::optional<RefinedMaxwell> other = refined_maxwell(*more, simplification, false, options, poses);
          detail::largest_error(other->matrix, bodies) < detail::largest_error(answer->matrix, bodies))
        return std::move(other->matrix);
  } catch (const Interrupted&) {
    // The answer by functions is the best one.
  }
  return std::move(answer->matrix);
}

/// Writes which conductors and entries have to be accurate.
void choose_asked(Entries entries, ChargedBodies& bodies) {
  const std::size_t grounded = count_of(bodies, Role::grounded) + count_of(bodies, Role::floating);
  if (entries == Entries::all || grounded == bodies.conductors.size())
    return;
  bodies.are_entries_asked = entries != Entries::of_readings;
  if (!bodies.are_entries_asked && !bodies.readings.empty()) {
    VectorXd used = VectorXd::Zero(bodies.readings.front().sense.size());
    for (const detail::ChargedReading& reading : bodies.readings)
      used += reading.sense.cwiseAbs() + reading.drive;
    for (Index k = 0; k < used.size(); ++k) {
      detail::ChargedConductor& conductor = bodies.conductors[static_cast<std::size_t>(k)];
      conductor.is_asked = used[k] > 0 || conductor.role == Role::floating;
    }
    return;
  }
  for (detail::ChargedConductor& conductor : bodies.conductors)
    conductor.is_asked = conductor.role != Role::grounded;
}

MaxwellMatrix solve_conductors(const Scene& scene, const BoundaryElementOptions& options) {
  ChargedBodies bodies =
      detail::charged_bodies(scene, options.derivatives || options.entries == Entries::of_readings);
  choose_asked(options.entries, bodies);
  std::optional<detail::LinkPoses> poses;
  if (options.derivatives)
    poses.emplace(scene.links).update();
  std::optional<MaxwellMatrix> answer;
  double tolerance = simplification_part * options.rtol;
  for (int attempt = 1; !answer; ++attempt, tolerance /= simplified_less) {
    const Simplification simplification(bodies, tolerance, options.most_unknowns / most_triangles_part, {},
                                        attempt == 1 ? simplified_part : 1);
    answer = solve_as_needed(simplification, attempt < most_attempts, options, poses ? &*poses : nullptr);
  }
  answer->reached = detail::largest_error(*answer, bodies) <= options.rtol;
  return *std::move(answer);
}

MaxwellMatrix solve_with_insulators(const Scene& scene, const BoundaryElementOptions& options) {
  if (options.derivatives)
    throw InputError("boundary elements know no derivatives in scenes with dielectric bodies");
  detail::InsulatedBodies bodies = detail::insulated_bodies(scene, options.entries == Entries::of_readings);
  choose_asked(options.entries, bodies.conductors);
  std::vector<Eigen::AlignedBox3d> insulators;
  for (const detail::Insulator& insulator : bodies.insulators)
    insulators.push_back(insulator.box);
  /// Part of the triangles that are allowed, with which most machines are solved in less time.
  constexpr std::size_t first_part = 3;
  const std::size_t most = detail::most_triangles_beside_insulators(options);
  const auto simplified = [&](std::size_t most_triangles) {
    return Simplification(bodies.conductors, simplification_part * options.rtol, most_triangles, insulators);
  };
  const auto solve = [&](const Simplification& simplification) {
    detail::InsulatedBodies simple = bodies;
    simple.conductors = simplification.bodies();
    MaxwellMatrix answer = detail::insulated_maxwell(simple, simplification, options);
    answer.reached = detail::largest_error(answer, simple.conductors) <= options.rtol;
    return answer;
  };
  const Simplification first = simplified(most / first_part);
  MaxwellMatrix answer = solve(first);
  if (answer.reached || !first.is_changed())
    return answer;
  try {
    const Simplification second = simplified(most);
    if (second.triangles() > first.triangles())
      if (MaxwellMatrix other = solve(second);
          detail::largest_error(other, bodies.conductors) < detail::largest_error(answer, bodies.conductors))
        return other;
  } catch (const Interrupted&) {
    // The first answer is the best one.
  }
  return answer;
}

}  // namespace

void validate(const BoundaryElementOptions& options) {
  if (!(options.rtol >= strictest_rtol && options.rtol <= loosest_rtol))
    throw InputError(
        fmt::format("rtol {} must be from {} to {}", options.rtol, strictest_rtol, loosest_rtol));
}

MaxwellMatrix maxwell(const Scene& scene, const BoundaryElementOptions& options) {
  validate(options);
  if (scene.has_room)
    throw InputError("room: boundary elements compute only conductors in free space");
  MaxwellMatrix answer = detail::has_insulators(scene) ? solve_with_insulators(scene, options)
                                                       : solve_conductors(scene, options);
  const double factor = 4 * std::numbers::pi * vacuum_permittivity * scene.medium.relative_permittivity;
  answer.values *= factor;
  answer.charges *= factor;
  answer.errors *= factor;
  answer.delta_self *= factor;
  answer.delta_self_errors *= factor;
  for (ReadingAnswer& reading : answer.readings)
    detail::scale(reading, factor);
  return answer;
}

SceneCapacitance capacitance(const Scene& scene, const MaxwellMatrix& matrix, std::string_view answered_by) {
  SceneCapacitance answer;
  for (std::size_t s = 0; s < matrix.sensors; ++s) {
    SensorCapacitance felt{matrix.conductors[s], 0, 0, 0, false, {}};
    Index row = 0;
    for (std::size_t k = 0; k < matrix.conductors.size(); ++k)
      for (const std::string& name : matrix.members[k]) {
        const double charge = matrix.charges(row++, static_cast<Index>(s));
        if (k < matrix.sensors)
          continue;
        felt.objects.push_back({name, matrix.members[k].size() == 1 ? matrix.mutual(s, k) : -charge, 0, false,
                                std::string(answered_by),
                                matrix.errors(static_cast<Index>(s), static_cast<Index>(k))});
        felt.total += felt.objects.back().capacitance;
      }
    felt.voltage = divider_voltage(scene.sensors[s], felt.total);
    felt.delta_voltage = scene.sensors[s].input_voltage - felt.voltage;
    answer.sensors.push_back(std::move(felt));
  }
  return answer;
}

}  // namespace fringe
