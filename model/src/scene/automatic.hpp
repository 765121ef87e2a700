#pragma once

#include <cstddef>

#include "fringe/evaluation.hpp"
#include "numeric/interruption.hpp"
#include "scene/expected_seconds.hpp"
#include "scene/methods.hpp"

namespace fringe::detail {

/// Takes from another answer of the same reading what states the smaller error: the value with its
/// background, the change with its derivatives and the method's name, or both. A background that belongs to
/// neither is the difference of value and change.
void improve(ReadingAnswer& reading, const ReadingAnswer& other);

/// The method `auto` of a scene whose links move (LiveScene::evaluate).
class Automatic {
 public:
  /// Tells whether the reduced method is to answer before boundary elements do: it is prepared, or prepared
  /// in no more time than boundary elements are expected to take in so many poses, or have taken so far.
  bool prefers_reduction(const Methods& methods, const SceneSize& size, const EvaluationOptions& asked,
                         std::size_t poses) const;

  /// Evaluates the scene.
  /// @param limit the time after which the best answer so far is to do; null: there is none
  /// @throws InputError for scenes that all methods refuse, Interrupted where time or interruption leave no
  /// answer.
  Evaluation evaluate(Methods& methods, const Scene& scene, const SceneSize& size,
                      const EvaluationOptions& options, bool with_sensors, TimeLimit* limit);

 private:
  double spent_ = 0;  ///< seconds that boundary elements are counted to have taken
};

}  // namespace fringe::detail
