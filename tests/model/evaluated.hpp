#pragma once

#include "fringe/evaluation.hpp"
#include "fringe/live_scene.hpp"

namespace fringe {

/// Evaluates a scene once, in the poses that it has.
inline Evaluation evaluate(const Scene& scene, const EvaluationOptions& options = {}) {
  return LiveScene(scene).evaluate(options);
}

}  // namespace fringe
