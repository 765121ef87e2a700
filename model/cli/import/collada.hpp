#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "fringe/scene.hpp"

namespace fringe::cli {

/// Reads the nodes of a COLLADA file with this content as links and their triangles as meshes in metres, by
/// Assimp; `upright`: what is up in the file becomes z. Appends remarks to `warnings`. Throws InputError with
/// element and reason.
Scene read_collada(const std::filesystem::path& path, const std::string& content, bool upright,
                   std::vector<std::string>& warnings);

}  // namespace fringe::cli
