#pragma once

#include <filesystem>

#include "fringe/capacitance.hpp"
#include "fringe/scene.hpp"

namespace fringe::cli {

/// Writes a VTU file, whole or not at all: the triangles of fringe::conductors, in their order, three points
/// (m) each. Of every triangle `body`, one more than the place of its conductor, and for every sensor
/// `capacitance NAME` (F), what the triangle adds to what the sensor feels of the object; 0 for the sensors'
/// own triangles, +infinity on contact.
///
/// @throws InputError for options under which triangles are not evaluated one by one, and as capacitance()
/// does; std::runtime_error when the file cannot be written.
void write_vtu(const Scene& scene, const CapacitanceOptions& options, const std::filesystem::path& target);

}  // namespace fringe::cli
