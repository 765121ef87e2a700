#include "fringe/evaluation.hpp"

#include "fringe/live_scene.hpp"

namespace fringe {

Evaluation evaluate(const Scene& scene, const EvaluationOptions& options) {
  return LiveScene(scene).evaluate(options);
}

}  // namespace fringe
