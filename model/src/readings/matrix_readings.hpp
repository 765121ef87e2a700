#pragma once

#include <vector>

#include "fringe/maxwell_matrix.hpp"
#include "fringe/reading_answer.hpp"
#include "fringe/scene.hpp"

/// Readings by Maxwell matrices of the whole scene and of the scene without its targets.
namespace fringe::detail {

/// Returns the scene without its targets.
Scene without_targets(const Scene& scene);

/// Returns the sensors' own readings, of a scene that does not ask for changes: these are `delta_self`.
std::vector<ReadingAnswer> readings_of_sensors(const MaxwellMatrix& matrix);

/// Returns the readings by both matrices. The error of a change is the sum of those of value and background.
std::vector<ReadingAnswer> readings_of_matrices(const std::vector<Reading>& readings,
                                                const MaxwellMatrix& all, const MaxwellMatrix& background);

}  // namespace fringe::detail
