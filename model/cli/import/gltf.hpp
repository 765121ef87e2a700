#pragma once

#include <filesystem>

#include "fringe/scene.hpp"

namespace fringe::cli {

/// Reads the nodes of a glTF 2.0 model (.gltf, .glb) as links and their triangles as meshes in metres; the
/// axes are the file's, where y points up. Links are rigid: scaling and shear of the nodes are applied to the
/// meshes. Throws InputError with file, element and reason.
Scene read_gltf(const std::filesystem::path& path);

}  // namespace fringe::cli
