#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "fringe/scene.hpp"

namespace fringe::cli {

/// What of a link is taken.
enum class UrdfGeometry { collision, visual };

/// Throws InputError for a name that is none.
UrdfGeometry parse_urdf_geometry(const std::string& name);

/// The links and bodies of a robot, all joints at position 0 (those that mimic others at their offset).
/// Meshes are in metres. A file in `package://NAME/…` is looked for in the folders `package_paths`, in each
/// as NAME/…, then in those around the URDF file. Throws InputError with file, element and reason.
Scene read_urdf(const std::filesystem::path& path, UrdfGeometry geometry,
                const std::vector<std::filesystem::path>& package_paths);

}  // namespace fringe::cli
