#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "fringe/evaluation.hpp"
#include "geometry/link_motion.hpp"
#include "reduced/machine_readings.hpp"
#include "reduced/reduced_capacitance.hpp"
#include "scene/expected_seconds.hpp"
#include "scene/readings_of_objects.hpp"
#include "scene/scene_evaluator.hpp"

namespace fringe::detail {

/// Returns the largest error that an answer states of what is asked for: of value and change of every
/// reading, and of the entries asked for; of the entries alone if all are, or there are no readings. Relative
/// to these. Infinity if one of them is not known.
double stated_error(const Evaluation& answer, const Scene& scene, Entries entries);

/// Least accuracy for which a machine is prepared roughly first: so much its answers state in most scenes.
constexpr double least_rough_rtol = 5e-2;

/// Tells the reduced method whether to prepare a machine again where a rough preparation does not suffice.
enum class Refinement { none, allowed };

/// The methods by which a scene whose links move is evaluated. Each is prepared when it first answers; the
/// scene must be the same in every call, except for its poses. What an exception leaves incomplete is
/// prepared again.
class Methods {
 public:
  Methods(const Scene& scene, const SceneSize& size, std::shared_ptr<LinkPoses> poses);

  /// Keeps what the reduced method prepares in files from now on; null: in none.
  void keep_in(std::shared_ptr<const PreparedFiles> files);

  /// Answers by a triangle-integral method.
  void integrate(const Scene& scene, const EvaluationOptions& asked, Evaluation& answer);

  /// Answers by the formula, object by object.
  void combine(const Scene& scene, const EvaluationOptions& asked, Evaluation& answer);

  /// Answers by the reduced method: by its matrix if entries are asked for or the scene is small, else the
  /// readings before a machine, which is prepared roughly first if that may do.
  /// @param with_sensors whether more than the readings is asked for
  /// @param contacts which bodies may touch
  /// @param refinement whether the readings before a machine may be prepared where the matrix does not
  /// suffice
  void reduce(const Scene& scene, const EvaluationOptions& asked, bool with_sensors, ReducedContacts contacts,
              Refinement refinement, Evaluation& answer);

  /// Answers with the readings before a machine.
  /// @param is_rough whether the machine is prepared roughly, else for the accuracy
  void reduce_before_machine(const Scene& scene, const EvaluationOptions& asked, bool is_rough,
                             bool with_sensors, Evaluation& answer);

  /// Answers by boundary elements.
  static void solve(const Scene& scene, const EvaluationOptions& asked, Evaluation& answer);

  /// Returns the readings in so many frames of a motion by the reduced method; none where it does not answer
  /// many frames at once.
  /// @param pose sets the poses of a frame
  std::optional<std::vector<std::vector<ReadingAnswer>>>
  readings_of(const Scene& scene, std::size_t frames, const std::function<void(std::size_t)>& pose,
              double rtol, Refinement refinement, std::size_t threads);

  /// Tells whether a rough preparation of a machine may answer.
  bool may_be_rough(double rtol, Entries entries) const {
    return rtol >= least_rough_rtol && !matrix_is_quick_ && has_machine(entries);
  }
  /// Tells whether that has answered before.
  bool is_roughly_prepared() const { return is_roughly_prepared_; }
  /// Tells whether the readings before a machine are known, prepared roughly or for an accuracy.
  bool has_machine(Entries entries) const { return knows_readings_ && entries == Entries::of_readings; }
  /// Tells whether the reduced method answers in bounded time: whether its matrix has few triangles to
  /// prepare, or readings are asked for that it knows before a machine.
  bool reduction_is_bounded(Entries entries) const {
    return matrix_is_small_ || (knows_readings_ && !has_insulators_ && entries == Entries::of_readings);
  }
  /// Tells whether the reduced method answers by a matrix, unless bodies on different links touch.
  bool reduces_to_matrix(Entries entries) const {
    return entries != Entries::of_readings || matrix_is_quick_ || has_insulators_ || !knows_readings_;
  }
  /// Tells whether the reduced method is prepared for an accuracy.
  bool is_reduction_prepared(double rtol, Entries entries) const;

 private:
  template <typename Answer>
  auto whole(const Answer& answer) -> decltype(answer());
  const SceneCapacitance& capacitance(const Scene& scene, const EvaluationOptions& options);
  void find_by_formula(const Scene& scene, Evaluation& answer);
  bool reduces_to_matrix(const Scene& scene, const EvaluationOptions& asked, ReducedContacts contacts,
                         Evaluation& answer);
  const MaxwellMatrix& reduced_matrix(const Scene& scene, double rtol, ReducedContacts contacts,
                                      bool with_derivatives);

  std::shared_ptr<LinkPoses> poses_;
  ReadingsOfObjects readings_of_objects_;
  bool can_read_;        ///< the readings can be found before a machine
  bool knows_readings_;  ///< and the scene asks for their changes
  bool has_insulators_, matrix_is_small_, matrix_is_quick_;
  std::optional<SceneEvaluator> evaluator_;
  std::string evaluator_method_;  ///< with its rules
  double evaluator_tolerance_ = 0;
  std::optional<ReducedEvaluator> reduced_;
  double reduced_rtol_ = 0;  ///< that it was asked for
  double sharper_ = 1;       ///< part of it that its bodies are prepared for
  ReducedContacts reduced_contacts_ = ReducedContacts::all;
  MachineReadings rough_readings_;
  MachineReadings readings_;  ///< at an accuracy
  bool is_roughly_prepared_ = false;
  std::optional<double> prepared_rtol_;  ///< of readings_
  std::shared_ptr<const PreparedFiles> files_;
};

}  // namespace fringe::detail
