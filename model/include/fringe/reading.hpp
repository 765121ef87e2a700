#pragma once

#include <vector>

#include "fringe/scene.hpp"

namespace fringe {

/// Returns the readings of a scene: those that it holds, with five times the noise as the threshold where
/// only the noise is given; without any, one for every sensor, with its name, that senses and drives it.
std::vector<Reading> readings(const Scene& scene);

/// Returns for every object whether it is a target, which comes and goes: those that are marked, or, if none
/// is, all except electrodes.
std::vector<bool> targets(const Scene& scene);

/// Tells whether a scene asks what targets change: it marks a target, has readings of its own, or has objects
/// that are no targets. Otherwise each sensor has a reading, and what all objects change is `delta_self`.
bool asks_for_changes(const Scene& scene);

}  // namespace fringe
