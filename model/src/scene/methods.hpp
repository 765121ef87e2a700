#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "correction/insulated_readings.hpp"
#include "fringe/evaluation.hpp"
#include "geometry/link_motion.hpp"
#include "reduced/reduced_capacitance.hpp"
#include "scene/expected_seconds.hpp"
#include "scene/readings_of_objects.hpp"
#include "scene/scene_evaluator.hpp"

namespace fringe::detail {

/// Returns the largest error that an answer states of what is asked for: of value and change of every
/// reading, and of the entries asked for; of the entries alone if all are, or there are no readings. Relative
/// to these. Infinity if one of them is not known.
double stated_error(const Evaluation& answer, const Scene& scene, Entries entries);

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

  /// Answers by the formula: the changes of readings with the conductors around them where it knows these.
  /// @param with_sensors whether more than the readings is asked for
  void combine(const Scene& scene, const EvaluationOptions& asked, bool with_sensors, Evaluation& answer);

  /// Answers by the reduced method: by its matrix if entries are asked for or the scene is small, else the
  /// changes of readings before a machine.
  /// @param contacts which bodies may touch
  void reduce(const Scene& scene, const EvaluationOptions& asked, bool with_sensors, ReducedContacts contacts,
              Evaluation& answer);

  /// Answers by boundary elements.
  static void solve(const Scene& scene, const EvaluationOptions& asked, Evaluation& answer);

  /// Returns the readings in so many frames of a motion by the formula or, with an rtol, the reduced method;
  /// none where they do not answer many frames at once.
  /// @param pose sets the poses of a frame
  std::optional<std::vector<std::vector<ReadingAnswer>>>
  readings_of(const Scene& scene, std::size_t frames, const std::function<void(std::size_t)>& pose,
              std::optional<double> rtol, std::size_t threads);

  /// Tells whether the formula knows the changes of the readings with the conductors around them.
  bool knows_surroundings() const { return knows_surroundings_; }
  /// Tells whether the reduced method answers in bounded time: whether its matrix has few triangles to
  /// prepare, or readings are asked for that it knows before a machine.
  bool reduction_is_bounded(Entries entries) const {
    return matrix_is_small_ || (takes_rtol_ && entries == Entries::of_readings);
  }
  /// Tells whether the reduced method answers by a matrix, unless bodies on different links touch.
  bool reduces_to_matrix(Entries entries) const {
    return entries != Entries::of_readings || matrix_is_small_ || !takes_rtol_;
  }
  /// Tells whether the reduced method is prepared for an accuracy.
  bool is_reduction_prepared(double rtol, Entries entries) const;

 private:
  template <typename Answer>
  auto whole(const Answer& answer) -> decltype(answer());
  const SceneCapacitance& capacitance(const Scene& scene, const CapacitanceOptions& options);
  void find_by_formula(const Scene& scene, Evaluation& answer);
  bool reduces_to_matrix(const Scene& scene, const EvaluationOptions& asked, ReducedContacts contacts,
                         Evaluation& answer);
  const MaxwellMatrix& reduced_matrix(const Scene& scene, double rtol, ReducedContacts contacts,
                                      bool with_derivatives);

  std::shared_ptr<LinkPoses> poses_;
  ReadingsOfObjects readings_of_objects_;
  bool knows_surroundings_, takes_rtol_, matrix_is_small_;
  std::optional<SceneEvaluator> evaluator_;
  CapacitanceOptions evaluator_options_;
  std::optional<ReducedEvaluator> reduced_;
  double reduced_rtol_ = 0;  ///< that it was asked for
  double sharper_ = 1;       ///< part of it that its bodies are prepared for
  ReducedContacts reduced_contacts_ = ReducedContacts::all;
  InsulatedReadings closed_;             ///< in closed form
  InsulatedReadings reduced_readings_;   ///< at an accuracy
  std::optional<double> prepared_rtol_;  ///< of these
  std::shared_ptr<const PreparedFiles> files_;
};

}  // namespace fringe::detail
