#pragma once

#include <filesystem>

#include "fringe/scene.hpp"

namespace fringe::cli {

/// The nodes of a glTF 2.0 model (.gltf, .glb) as links, their triangles as meshes in metres; the axes are
/// the file's, where y is up. Links are rigid: what nodes scale or shear is in the meshes. Throws InputError
/// with file, element and reason.
Scene read_gltf(const std::filesystem::path& path);

}  // namespace fringe::cli
