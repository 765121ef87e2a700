#pragma once

#include <filesystem>

#include "fringe/evaluation.hpp"
#include "fringe/scene.hpp"

namespace fringe::cli {

/// Writes a VTU file, completely or not at all: the triangles of fringe::conductors, in their order, three
/// points (m) each. Every triangle has `body`, the index of its conductor counted from 1, and for every
/// sensor `capacitance NAME` (F), the triangle's contribution to the sensor's capacitance; 0 for the sensors'
/// own triangles, +infinity on contact.
///
/// @throws InputError for options under which triangles are not evaluated one by one, and as capacitance()
/// does; std::runtime_error when the file cannot be written.
void write_vtu(const Scene& scene, const EvaluationOptions& options, const std::filesystem::path& target);

}  // namespace fringe::cli
