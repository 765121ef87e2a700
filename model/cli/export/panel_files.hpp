#pragma once

#include <cstddef>
#include <map>
#include <string>

#include "fringe/scene.hpp"

namespace fringe::cli {

/// A list of FastCap and FasterCap, and its files of panels.
struct PanelFiles {
  std::string list;
  std::map<std::string, std::string> files;  ///< contents by file name
  std::size_t conductors = 0;
  std::size_t panels = 0;
};

/// Writes the conductors of a scene, in metres in the frame of the world, as a list. Each is a group of
/// files, one for each of its sensors or objects; their names begin with `stem`. Grounded objects that touch
/// are one conductor. Parallelograms become quadrilaterals, all other panels are triangles. Throws InputError
/// for a scene with a room or a dielectric object, and for conductors that touch though their potentials
/// differ.
PanelFiles panel_files(const Scene& scene, const std::string& stem);

}  // namespace fringe::cli
