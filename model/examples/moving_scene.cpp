// A scene that moves.
//
// LiveScene owns a scene whose links move, and answers again and again what its sensors feel, which objects
// collide and what the distance sensors see. It evaluates only the pairs of a sensor and an object whose pose
// relative to each other has changed, and keeps the other values. The counts of an answer say what was
// evaluated.
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

#include "fringe/live_scene.hpp"
#include "fringe/scene_reader.hpp"

int main(int count, char** arguments) {
  fringe::LiveScene scene(fringe::load_scene(count > 1 ? arguments[1] : "hand.toml"));
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  for (const double height : {0.0, 0.02, 0.05, 0.1, 0.2}) {
    pose.translation().z() = height;
    scene.set_pose("arm", pose);
    const fringe::SceneCapacitance& answer = scene.evaluate().capacitance;
    std::printf("raised by %4.0f mm: %.4f pF, objects evaluated: %zu\n", 1000 * height,
                1e12 * answer.sensors[0].total, answer.counts.objects_evaluated);
  }
  const fringe::SceneCapacitance& again = scene.evaluate().capacitance;
  std::printf("asked again:       %.4f pF, objects evaluated: %zu\n", 1e12 * again.sensors[0].total,
              again.counts.objects_evaluated);
}
