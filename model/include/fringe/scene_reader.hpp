#pragma once

#include <filesystem>

#include "fringe/scene.hpp"

namespace fringe {

/// Reads a scene file as geometries/SCENE.md describes it, with the mesh files it names. Throws InputError
/// with "FILE:LINE: KEY: REASON" for everything that SCENE.md calls an error.
Scene load_scene(const std::filesystem::path& path);

}  // namespace fringe
