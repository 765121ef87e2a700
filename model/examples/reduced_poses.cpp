// The reduced method at many poses.
//
// Boundary elements solve every pose from the beginning. When bodies are rigid, their own equations can be
// solved once; a LiveScene that is asked for the reduced method does so and then answers each pose in
// microseconds. It states an error with every answer, as boundary elements do: `reached` says whether it is
// within the accuracy asked for.
//
// Run it:  build/examples/reduced_poses model/examples/hand.toml
// Expect:  at 1000 poses the reduced method agrees with boundary elements, which are asked at every
// hundredth pose.
//
// Output:
//   mutual capacitance from 0.975 to 3.857 pF
//   accuracy of 0.1 % reached at 1000 of 1000 poses
//   within 0.1 % of boundary elements: yes

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "fringe/live_scene.hpp"
#include "fringe/pose.hpp"
#include "fringe/scene_reader.hpp"

int main(int count, char** arguments) {
  fringe::LiveScene scene(fringe::load_scene(count > 1 ? arguments[1] : "hand.toml"));
  constexpr int poses = 1000;
  int reached = 0;
  double least = 1e300, greatest = 0, worst_difference = 0;
  for (int k = 0; k < poses; ++k) {
    const double share = static_cast<double>(k) / poses;
    const Eigen::Isometry3d pose =
        fringe::pose_from_axis({0, 0, 1}, 360 * share, {0.05 * share, 0, 0.1 * share});
    scene.set_pose("arm", pose);
    const fringe::Evaluation& answer =
        scene.evaluate({.method = fringe::Reduced{}, .rtol = 1e-3, .entries = fringe::Entries::of_sensors});
    const double mutual = answer.matrix->mutual(0, 1);
    reached += answer.reached;
    least = std::min(least, mutual);
    greatest = std::max(greatest, mutual);
    if (k % 100 == 0) {
      const double truth = fringe::maxwell(scene.scene(), {.rtol = 1e-4}).mutual(0, 1);
      worst_difference = std::max(worst_difference, std::abs(mutual / truth - 1));
    }
  }
  std::printf("mutual capacitance from %.3f to %.3f pF\n", 1e12 * least, 1e12 * greatest);
  std::printf("accuracy of 0.1 %% reached at %d of %d poses\n", reached, poses);
  std::printf("within 0.1 %% of boundary elements: %s\n", worst_difference < 1e-3 ? "yes" : "no");
}
