#pragma once

#include <filesystem>
#include <string>

#include "fringe/scene.hpp"

namespace fringe::cli {

/// Writes the links and objects of a scene as a scene file (geometries/SCENE.md), its meshes as STL files in
/// a folder beside it: all of it, or nothing. A comment in the file names `source`. Throws InputError for a
/// scene that load_scene would refuse, std::runtime_error when a file cannot be written.
void write_scene_file(const Scene& scene, const std::filesystem::path& target, const std::string& source);

}  // namespace fringe::cli
