#pragma once

#include <filesystem>
#include <vector>

#include "fringe/triangle.hpp"

namespace fringe {

/// Reads the faces of an STL, OBJ or PLY file (by extension) in the file's order. Polygons are divided as
/// geometries/SCENE.md says; points and lines are ignored. Throws InputError when the file is missing,
/// damaged or without faces.
std::vector<Triangle> read_mesh_file(const std::filesystem::path& path);

}  // namespace fringe
