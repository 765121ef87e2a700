#include "scene/methods.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "fringe/error.hpp"
#include "fringe/reading.hpp"
#include "numeric/infinity.hpp"
#include "readings/readings.hpp"
#include "reduced/rigid_bodies.hpp"
#include "surface/charged_readings.hpp"
#include "surface/insulators.hpp"

namespace fringe::detail {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

/// Largest number of triangles that the matrix of the reduced method may have to prepare before readings
/// alone are cheaper: some seconds, once for all poses.
constexpr double most_prepared_triangles = 4'000;

/// Largest number of bodies in that matrix: 100 boxes took more than 11 s of processor time, which grows like
/// the number of pairs.
constexpr double most_bodies = 30;

/// Part of the geometric mean of two diagonal entries below which the entry between them need not be
/// accurate.
constexpr double least_part = 1e-3;

/// Least error that can be asked of the reduced matrix; less is stated as not reached.
constexpr double least_reduced_rtol = 1e-4;

/// Part of the accuracy for which bodies are prepared again where they do not suffice for it.
constexpr double sharpened = 0.3;

/// Least error of the reduced matrix, relative, for which the readings before a machine are asked instead:
/// these hardly reach less.
constexpr double least_read_rtol = 1e-2;

/// Least accuracy for which a rough preparation is all that is made.
constexpr double least_merely_rough_rtol = 0.1;

/// Tells whether the reduced method's matrix takes no more than some seconds to prepare. Dielectric bodies
/// take seconds to prepare, and many milliseconds for every pose.
bool is_small(const SceneSize& size) {
  return !size.has_insulators && size.bodies() <= most_bodies &&
         size.prepared_triangles <= most_prepared_triangles;
}

/// Returns error/scale; infinity if that is not a number, and 0 for the certain answers of contact.
double relative(double error, double scale) {
  if (error == 0)
    return 0;
  const double part = error / scale;
  if (std::isnan(part))
    return infinity;
  return part;
}

/// Returns for each conductor of a matrix whether its row is asked for: all, or sensors and electrodes if
/// there are any.
std::vector<bool> are_asked(const MaxwellMatrix& matrix, const Scene& scene, Entries entries) {
  std::vector<bool> asked(matrix.members.size(), entries == Entries::all);
  if (entries == Entries::all)
    return asked;
  for (std::size_t k = 0; k < asked.size(); ++k) {
    const auto object = std::ranges::find(scene.objects, matrix.members[k].front(), &Object::name);
    asked[k] = k < matrix.sensors ||
               (object != scene.objects.end() && std::holds_alternative<Electrode>(object->role));
  }
  if (std::ranges::count(asked, true) == 0)
    asked.assign(asked.size(), true);
  return asked;
}

void name_readings(std::vector<ReadingAnswer>& readings, const std::string& answered_by) {
  for (ReadingAnswer& reading : readings)
    reading.answered_by = answered_by;
}

/// Forgets what a method does not know: numbers of which it says that they may be off by anything.
void forget_unknown(std::vector<ReadingAnswer>& readings) {
  for (ReadingAnswer& reading : readings)
    for (Estimate* const each : {&reading.value, &reading.background, &reading.change})
      if (each->value && (std::isnan(*each->value) || (each->error && !std::isfinite(*each->error))))
        *each = {};
}

/// Fills in what follows from the matrix of an answer.
void take_matrix(const Scene& scene, bool with_sensors, Evaluation& answer) {
  name_readings(answer.matrix->readings, answer.answered_by);
  forget_unknown(answer.matrix->readings);
  if (with_sensors)
    answer.capacitance = fringe::capacitance(scene, *answer.matrix, answer.answered_by);
  answer.readings = answer.matrix->readings;
}

double error_of_entries(const MaxwellMatrix& matrix, const Scene& scene, Entries entries) {
  const std::vector<bool> asked = are_asked(matrix, scene, entries);
  const VectorXd roots = matrix.values.diagonal().cwiseAbs().cwiseSqrt();
  double largest = 0;
  for (Index row = 0; row < matrix.values.rows(); ++row)
    for (Index column = 0; asked[static_cast<std::size_t>(row)] && column < matrix.values.cols(); ++column)
      largest = std::max(
          largest, relative(matrix.errors(row, column), std::max(std::abs(matrix.values(row, column)),
                                                                 least_part * roots[row] * roots[column])));
  return largest;
}

/// Returns what the errors of the readings' values are relative to, by a matrix that has them.
VectorXd value_scales(const MaxwellMatrix& matrix, const Scene& scene) {
  const std::vector<ChargedReading> charged = charged_readings(readings(scene), matrix.conductors);
  const auto energy = [&](const VectorXd& potentials) { return potentials.dot(matrix.values * potentials); };
  VectorXd scales(static_cast<Index>(charged.size()));
  for (std::size_t k = 0; k < charged.size(); ++k)
    scales[static_cast<Index>(k)] =
        least_part * std::sqrt(energy(charged[k].sense) * energy(charged[k].drive));
  return scales;
}

}  // namespace

double stated_error(const Evaluation& answer, const Scene& scene, Entries entries) {
  const bool needs_matrix = entries != Entries::of_readings || answer.readings.empty();
  if (needs_matrix && !answer.matrix)
    return infinity;
  double largest = needs_matrix ? error_of_entries(*answer.matrix, scene, entries) : 0;
  VectorXd scales;
  for (std::size_t k = 0; entries != Entries::all && k < answer.readings.size(); ++k) {
    const Estimate &value = answer.readings[k].value, &change = answer.readings[k].change;
    if (!change.value || !change.error)
      return infinity;
    largest =
        std::max(largest, relative(*change.error, change_scale(value.value.value_or(0), *change.value)));
    if (!value.value)
      continue;
    const double error = value.error.value_or(infinity), size = std::abs(*value.value);
    // Values are mostly more accurate than changes, and no small part of what their conductors have.
    if (relative(error, size) <= largest)
      continue;
    if (answer.matrix && scales.size() == 0)
      scales = value_scales(*answer.matrix, scene);
    const double least = answer.matrix ? scales[static_cast<Index>(k)] : 0;
    largest = std::max(largest, relative(error, std::max(size, least)));
  }
  return largest;
}

Methods::Methods(const Scene& scene, const SceneSize& size, std::shared_ptr<LinkPoses> poses)
    : poses_(std::move(poses)), readings_of_objects_(scene), can_read_(MachineReadings::knows(scene)),
      knows_readings_(can_read_ && asks_for_changes(scene)), has_insulators_(size.has_insulators),
      matrix_is_small_(!scene.has_room && is_small(size)),
      // Plates and boxes take milliseconds to prepare.
      matrix_is_quick_(matrix_is_small_ && size.curved == 0), rough_readings_(poses_), readings_(poses_) {}

void Methods::keep_in(std::shared_ptr<const PreparedFiles> files) {
  files_ = std::move(files);
  rough_readings_.keep_in(files_);
  readings_.keep_in(files_);
}

/// Returns an answer; ends the preparations that an exception leaves incomplete, which must not serve the
/// next one.
template <typename Answer>
auto Methods::whole(const Answer& answer) -> decltype(answer()) {
  try {
    return answer();
  } catch (const InputError&) {
    throw;
  } catch (...) {
    evaluator_.reset();
    reduced_.reset();
    rough_readings_ = MachineReadings(poses_);
    readings_ = MachineReadings(poses_);
    is_roughly_prepared_ = false;
    keep_in(files_);
    prepared_rtol_.reset();
    throw;
  }
}

const SceneCapacitance& Methods::capacitance(const Scene& scene, const EvaluationOptions& options) {
  refuse_thick_covers(scene);
  std::string method = method_text(options);
  if (!evaluator_ || method != evaluator_method_ || options.tolerance != evaluator_tolerance_) {
    evaluator_.emplace(scene, options, poses_);
    evaluator_method_ = std::move(method);
    evaluator_tolerance_ = options.tolerance;
  }
  return evaluator_->capacitance();
}

void Methods::integrate(const Scene& scene, const EvaluationOptions& asked, Evaluation& answer) {
  answer.answered_by = method_text(asked);
  answer.matrix.reset();
  answer.reached = true;
  answer.capacitance = capacitance(scene, asked);
  readings_of_objects_.write(answer.capacitance, answer.answered_by, answer.readings);
  if (asked.derivatives)
    readings_of_objects_.write_derivatives(*evaluator_, *poses_, answer.readings);
}

void Methods::combine(const Scene& scene, const EvaluationOptions& asked, Evaluation& answer) {
  answer.answered_by = to_string(Method(Formula{}));
  answer.matrix.reset();
  find_by_formula(scene, answer);
  readings_of_objects_.write(answer.capacitance, answer.answered_by, answer.readings);
  // Asked by itself it states no error; of contact it is certain.
  answer.reached = !asked.rtol || stated_error(answer, scene, Entries::of_readings) <= *asked.rtol;
}

/// Writes what each object adds to each sensor.
void Methods::find_by_formula(const Scene& scene, Evaluation& answer) {
  answer.capacitance = capacitance(scene, {.method = Formula{}});
}

/// Returns the matrix of the reduced method, prepared for an accuracy, or for `sharper_` times it and for the
/// changes of readings, which take half of the time of a pose.
const MaxwellMatrix& Methods::reduced_matrix(const Scene& scene, double rtol, ReducedContacts contacts,
                                             bool with_derivatives) {
  return whole([&]() -> const MaxwellMatrix& {
    if (!reduced_ || rtol != reduced_rtol_ || contacts != reduced_contacts_) {
      if (rtol != reduced_rtol_)
        sharper_ = 1;
      reduced_.reset();
      reduced_.emplace(scene,
                       ReducedOptions{.rtol = std::max(sharper_ * rtol, least_reduced_rtol),
                                      .contacts = contacts,
                                      .with_changes = sharper_ < 1},
                       poses_);
      reduced_rtol_ = rtol;
      reduced_contacts_ = contacts;
    }
    return reduced_->maxwell(with_derivatives);
  });
}

/// Tries to find the reduced matrix. Where the readings can be found without it, bodies of too many panels
/// have none. Where they ask for changes, no scene that it refuses has one, and it is not worth seconds for
/// every pose: bodies on different links may not touch then.
bool Methods::reduces_to_matrix(const Scene& scene, const EvaluationOptions& asked, ReducedContacts contacts,
                                Evaluation& answer) {
  answer.matrix.reset();
  if (!reduces_to_matrix(asked.entries))
    return false;
  const bool of_readings = asked.entries == Entries::of_readings;
  const bool is_known = of_readings && knows_readings_;
  try {
    const ReducedContacts allowed = is_known ? ReducedContacts::of_one_link : contacts;
    answer.matrix = reduced_matrix(scene, rtol_of(asked), allowed, asked.derivatives);
    return true;
  } catch (const TooManyPanels&) {
    if (!of_readings || !can_read_)
      throw;
  } catch (const InputError&) {
    if (!is_known)
      throw;
  }
  return false;
}

/// Finds the readings before a machine.
void Methods::reduce_before_machine(const Scene& scene, const EvaluationOptions& asked, bool is_rough,
                                    bool with_sensors, Evaluation& answer) {
  const double rtol = rtol_of(asked);
  answer.answered_by = to_string(Method(Reduced{}));
  answer.capacitance = {};
  answer.matrix.reset();
  refuse_thick_covers(scene);
  whole([&] {
    MachineReadings& readings = is_rough ? rough_readings_ : readings_;
    readings.write(scene, answer.readings, {rtol, is_rough}, asked.derivatives);
    if (is_rough)
      is_roughly_prepared_ = true;
    else
      prepared_rtol_ = rtol;
    if (asked.derivatives)
      readings.write_derivatives(answer.readings);
    name_readings(answer.readings, answer.answered_by);
    if (with_sensors)
      find_by_formula(scene, answer);
  });
  answer.reached = stated_error(answer, scene, asked.entries) <= rtol;
}

void Methods::reduce(const Scene& scene, const EvaluationOptions& asked, bool with_sensors,
                     ReducedContacts contacts, Refinement refinement, Evaluation& answer) {
  const double rtol = rtol_of(asked);
  if (may_be_rough(rtol, asked.entries)) {
    reduce_before_machine(scene, asked, true, with_sensors, answer);
    if (answer.reached || rtol >= least_merely_rough_rtol)
      return;
  }
  answer.answered_by = to_string(Method(Reduced{}));
  answer.capacitance = {};
  if (!reduces_to_matrix(scene, asked, contacts, answer)) {
    reduce_before_machine(scene, asked, false, with_sensors, answer);
    return;
  }
  take_matrix(scene, with_sensors, answer);
  double error = stated_error(answer, scene, asked.entries);
  // The errors of changes are not those of entries, for which the bodies are prepared.
  if (error > rtol && std::isfinite(error) && sharper_ == 1 && rtol > least_reduced_rtol) {
    sharper_ = sharpened;
    reduced_.reset();
    if (reduces_to_matrix(scene, asked, contacts, answer))
      take_matrix(scene, with_sensors, answer);
    error = stated_error(answer, scene, asked.entries);
  }
  answer.reached = error <= rtol;
  if (answer.matrix)
    answer.matrix->reached = answer.reached;
  // A machine's functions are the finer the nearer its targets are, which those of single bodies are not.
  if (refinement == Refinement::none || !std::isfinite(error) || error <= std::max(rtol, least_read_rtol) ||
      !knows_readings_ || has_insulators_ || asked.entries != Entries::of_readings)
    return;
  Evaluation before_machine;
  EvaluationOptions reachable = asked;
  reachable.rtol = std::max(rtol, least_read_rtol);
  reduce_before_machine(scene, reachable, false, with_sensors, before_machine);
  const double other_error = stated_error(before_machine, scene, asked.entries);
  if (other_error >= error)
    return;
  answer = std::move(before_machine);
  answer.reached = other_error <= rtol;
}

void Methods::solve(const Scene& scene, const EvaluationOptions& asked, Evaluation& answer) {
  answer.answered_by = to_string(Method(BoundaryElements{}));
  // What has no readings has nothing but its entries.
  const bool has_readings = !readings(scene).empty();
  answer.matrix =
      maxwell(scene, {.rtol = rtol_of(asked),
                      .entries = asked.entries == Entries::of_readings && !has_readings ? Entries::of_sensors
                                                                                        : asked.entries,
                      .derivatives = asked.derivatives,
                      .before_refinement = asked.before_refinement});
  take_matrix(scene, true, answer);
  answer.reached = answer.matrix->reached;
}

std::optional<std::vector<std::vector<ReadingAnswer>>>
Methods::readings_of(const Scene& scene, std::size_t frames, const std::function<void(std::size_t)>& pose,
                     double rtol, Refinement refinement, std::size_t threads) {
  const auto answers_by = [&](MachineReadings& readings, bool is_rough) {
    return whole([&] {
      auto answers = readings.write_frames(scene, frames, pose, {rtol, is_rough}, threads);
      for (std::vector<ReadingAnswer>& frame : answers)
        name_readings(frame, to_string(Method(Reduced{})));
      return answers;
    });
  };
  if (may_be_rough(rtol, Entries::of_readings)) {
    auto answers = answers_by(rough_readings_, true);
    if (rtol >= least_merely_rough_rtol || refinement == Refinement::none ||
        std::ranges::all_of(answers, [&](const auto& frame) { return are_within(frame, rtol); }))
      return answers;
  }
  if (reduces_to_matrix(Entries::of_readings) || refinement == Refinement::none)
    return std::nullopt;
  auto answers = answers_by(readings_, false);
  prepared_rtol_ = rtol;
  return answers;
}

bool Methods::is_reduction_prepared(double rtol, Entries entries) const {
  return reduces_to_matrix(entries) ? reduced_ && reduced_rtol_ == rtol : prepared_rtol_ == rtol;
}

}  // namespace fringe::detail
