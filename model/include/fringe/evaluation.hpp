#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "fringe/boundary_elements.hpp"
#include "fringe/capacitance.hpp"
#include "fringe/correction.hpp"
#include "fringe/method.hpp"
#include "fringe/reading_answer.hpp"
#include "fringe/scene.hpp"

namespace fringe {

/// The method that evaluates the sensors of a scene, and its options. An option that is left empty has the
/// method's default; one that the method does not have must be left empty.
struct EvaluationOptions {
  Method method = Exact{};
  std::optional<PlateRule> plates = {};       ///< of the triangle-integral methods; default sum
  std::optional<FaceRule> faces = {};         ///< of the triangle-integral methods; default all
  std::optional<double> tolerance = {};       ///< of the triangle-integral methods; default 0
  std::optional<Correction> correction = {};  ///< of the triangle-integral methods; default none
  /// Largest relative error asked for: of boundary elements (default 1e-3), of the reduced method (1e-2, 1e-3
  /// and 3e-4 for 1, 2 and 3 steps) and of `recommended` (1e-2); and, in the changes of readings in company,
  /// of the correction `formula` (no default: without it that answers in closed form).
  std::optional<double> rtol = {};
  /// Seconds after which the best answer so far is to do: of `recommended`, which does not begin what would
  /// take longer than what is left, and answers by the correction `formula` in closed form, in about a
  /// second and within ten, where it has nothing better. Boundary elements answer with their best matrix; the
  /// reduced method and the correction `formula` with an rtol throw Interrupted, as boundary elements do
  /// before their first matrix.
  std::optional<double> max_seconds = {};
  bool derivatives = false;  ///< also of the readings' changes with respect to poses; of exact without a
                             ///< correction, boundary elements, the reduced method and formula with an rtol
  Entries entries = Entries::of_sensors;  ///< that boundary elements refine
  /// Is called before each refinement of boundary elements; may be empty.
  std::function<void(const RefinementLevel&)> before_refinement = {};
  /// Folder in which what takes long to prepare is kept, and found again for the same bodies, readings, poses
  /// and accuracy: of the correction `formula` and of `recommended`, both with an rtol. It is made if there
  /// is none. The answers are the same, to the bit.
  std::optional<std::filesystem::path> prepared = {};
};

/// Throws InputError for options that are out of range, cannot be combined or belong to another method.
void validate(const EvaluationOptions& options);

/// Tells whether the correction `formula` takes an rtol in a scene: where this asks for the changes of
/// readings, has no dielectric objects and no room.
bool formula_takes_rtol(const Scene& scene);

/// Returns the options of a triangle-integral method, defaults filled in. Throws InputError for another
/// method, and for options that are out of range or cannot be combined.
CapacitanceOptions integral_options(const EvaluationOptions& options);

/// Returns the relative error asked for. Throws InputError for a method that has none, for one out of range
/// and for options that the method does not have.
double rtol_of(const EvaluationOptions& options);

/// The capacitances of a scene's sensors, by any method.
struct Evaluation {
  SceneCapacitance capacitance;
  std::optional<MaxwellMatrix> matrix;  ///< of boundary elements and the reduced method
  /// What the readings of the scene measure, in their order. The triangle-integral methods
  /// know the change of a reading that drives the sensor it senses: the sum over the targets. The corrections
  /// know the change of every reading in company (model/CORRECTIONS.md, section 8); asked for
  /// Entries::of_readings, they leave `capacitance` empty there.
  std::vector<ReadingAnswer> readings;
  /// The method that answered; "formula" for the correction of that name (model/CORRECTIONS.md).
  std::string answered_by;
  /// Tells whether the stated errors are within the error asked for. With `recommended` these are the errors
  /// of each sensor's own entry and of each object's capacitance, and of the readings' changes if the scene
  /// marks a target or has readings; `matrix->reached` means the same;
  /// otherwise those of the entries that were refined. True for methods of which no error can be asked.
  bool reached = true;
};

/// Evaluates every sensor of a scene by any method. `recommended` answers by the first of these that states
/// errors within the one asked for:
///
/// - the reduced method, if there are at most 30 bodies, and 4,000 triangles on those of them that are
///   neither plates nor boxes;
/// - boundary elements of at most 1,000 unknowns;
///
/// else by the one of the two that states the smaller error, if that is at most 10 %, else by the correction
/// `formula`, which states none.
///
/// @throws InputError for scenes that the method refuses, `recommended` for those that all three refuse; and
/// for options that are out of range, cannot be combined or belong to another method.
Evaluation evaluate(const Scene& scene, const EvaluationOptions& options = {});

}  // namespace fringe
