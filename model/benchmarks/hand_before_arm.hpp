#pragma once

#include <cstddef>
#include <vector>

#include "fringe/motion.hpp"
#include "fringe/scene.hpp"

namespace fringe::benchmarks {

/// Returns a fixed robot arm of eight overlapping parts, about 5,000 triangles, with eight sensors around its
/// forearm, and a hand, one mesh of about 2,000 triangles on a link of its own, as the target.
Scene hand_before_arm();

/// Returns poses of that hand from 30 cm to 2 cm above the sensors on top, in which it shifts and turns.
std::vector<Frame> hand_poses(const Scene& scene, std::size_t count);

/// Counts the triangles of a scene's targets, or of its other objects.
std::size_t triangles_of(const Scene& scene, bool of_targets);

}  // namespace fringe::benchmarks
