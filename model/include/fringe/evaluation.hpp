#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "fringe/boundary_elements.hpp"
#include "fringe/capacitance.hpp"
#include "fringe/method.hpp"
#include "fringe/reading_answer.hpp"
#include "fringe/scene.hpp"

namespace fringe {

/// The method that evaluates the sensors of a scene, and its options. An option that the method does not have
/// must keep its default.
struct EvaluationOptions {
  /// None: Auto where an rtol is given, Exact where not.
  std::optional<Method> method = {};
  PlateRule plates = PlateRule::sum;  ///< of the triangle-integral methods
  FaceRule faces = FaceRule::all;     ///< of the triangle-integral methods
  /// Largest part of a sensor's total that the evaluation may omit, relative to the total; the bounds of its
  /// objects state how much was omitted at most. 0: nothing except what the division among nearest plates
  /// needs, 1e-12. Only with the method Exact.
  double tolerance = 0;
  /// Largest relative error asked for of the value and the change of every reading, each sensor's own where
  /// the scene names none; from 1e-6 to 0.5. None: 1e-2. The triangle integrals and the formula,
  /// which state no error, have none.
  std::optional<double> rtol = {};
  /// The entries of the Maxwell matrix that must be as accurate, too: those of sensors tell what each object
  /// adds to a sensor. Only methods that find a matrix have them.
  Entries entries = Entries::of_readings;
  /// Seconds after which the best answer so far is to do; Interrupted is thrown where there is none by then.
  /// Not of the triangle-integral methods, which answer at once.
  std::optional<double> max_seconds = {};
  /// Also finds the derivatives of the readings' changes with respect to poses. Formula, Split and Gauss know
  /// none.
  bool derivatives = false;
  /// Is called before each refinement of boundary elements; may be empty.
  std::function<void(const RefinementLevel&)> before_refinement = {};
  /// Folder in which the reduced method keeps what takes long to prepare, and finds it again for the same
  /// bodies, readings, poses and accuracy; it is made if there is none. The answers are the same, to the bit.
  std::optional<std::filesystem::path> prepared = {};
};

/// Returns the method asked for.
Method method_of(const EvaluationOptions& options);

/// Returns the options with the method of a text that parse_method() reads, and with its rules: "+nearest"
/// and "+facing" after a triangle-integral method. Throws InputError for anything else.
EvaluationOptions with_method(EvaluationOptions options, std::string_view text);

/// Returns the text from which with_method() reads the method and its rules.
std::string method_text(const EvaluationOptions& options);

/// Throws InputError for options that are out of range, cannot be combined or belong to another method.
void validate(const EvaluationOptions& options);

/// Returns the relative error asked for, or the default one.
double rtol_of(const EvaluationOptions& options);

/// Evaluates the triangle-integral model (thesis 5.3): for each sensor and object ε₀·ε_r·Σ∫dA/d over the
/// sensor's plates and the object's triangles, and the output voltage for the sum (thesis 5.3.5); or the
/// formula in its place. Throws InputError when an object is not a grounded conductor (the model supports no
/// other) or has no triangles, when a vertex is not finite, when a plate is not a rectangle, for options that
/// are out of range or cannot be combined, and for other methods.
SceneCapacitance capacitance(const Scene& scene, const EvaluationOptions& options = {});

/// The answer of a method for a scene: the capacitances of its sensors, and its readings.
struct Evaluation {
  SceneCapacitance capacitance;
  std::optional<MaxwellMatrix> matrix;  ///< of boundary elements, and of the reduced method where it has one
  /// The readings in the order of the scene. The triangle-integral methods know only the change of a reading
  /// that drives the sensor it senses: the sum over the targets.
  std::vector<ReadingAnswer> readings;
  std::string answered_by;  ///< the method that answered; with Auto, readings may have one of their own
  /// Tells whether the stated errors are within the error asked for; true where none was asked for.
  bool reached = true;
  double expected_seconds = 0;  ///< estimated before the methods that were asked began
};

}  // namespace fringe
