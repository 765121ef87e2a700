#pragma once

#include <filesystem>
#include <string_view>

#include "fringe/scene.hpp"

namespace fringe {

/// Reads a scene file as geometries/SCENE.md describes it, with the mesh files it names. Throws InputError
/// with "FILE:LINE: KEY: REASON" for everything that SCENE.md calls an error.
Scene load_scene(const std::filesystem::path& path);

/// Reads the text of a scene file as load_scene() does; its mesh files are looked for in `folder`. In
/// messages "scene" stands for the file.
Scene parse_scene(std::string_view text, const std::filesystem::path& folder = {});

}  // namespace fringe
