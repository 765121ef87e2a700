// A scene that moves.
//
// SceneEvaluator answers the same scene again and again while links move. It evaluates only the pairs of a
// sensor and an object whose pose relative to each other has changed, and keeps the other values. The counts
// of an answer say what was evaluated.
//
// Run it:  build/examples/moving_scene model/examples/hand.toml
// Expect:  the capacitance falls as the hand moves away. Asked again without a new pose, nothing is
// evaluated.
//
// Output:
//   raised by    0 mm: 2.6755 pF, objects evaluated: 1
//   raised by   20 mm: 1.5613 pF, objects evaluated: 1
//   raised by   50 mm: 0.9670 pF, objects evaluated: 1
//   raised by  100 mm: 0.5929 pF, objects evaluated: 1
//   raised by  200 mm: 0.3346 pF, objects evaluated: 1
//   asked again:       0.3346 pF, objects evaluated: 0

#include <cstdio>

#include "fringe/scene_evaluator.hpp"
#include "fringe/scene_reader.hpp"

int main(int count, char** arguments) {
  fringe::SceneEvaluator evaluator(fringe::load_scene(count > 1 ? arguments[1] : "hand.toml"));
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  for (const double height : {0.0, 0.02, 0.05, 0.1, 0.2}) {
    pose.translation().z() = height;
    evaluator.set_pose("arm", pose);
    const fringe::SceneCapacitance& answer = evaluator.capacitance();
    std::printf("raised by %4.0f mm: %.4f pF, objects evaluated: %zu\n", 1000 * height,
                1e12 * answer.sensors[0].total, answer.counts.objects_evaluated);
  }
  const fringe::SceneCapacitance& again = evaluator.capacitance();
  std::printf("asked again:       %.4f pF, objects evaluated: %zu\n", 1e12 * again.sensors[0].total,
              again.counts.objects_evaluated);
}
