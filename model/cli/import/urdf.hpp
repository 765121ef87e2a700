#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "fringe/scene.hpp"

namespace fringe::cli {

/// The geometry that is imported from a link.
enum class UrdfGeometry { collision, visual };

/// Reads "collision" or "visual"; throws InputError for anything else.
UrdfGeometry parse_urdf_geometry(const std::string& name);

/// Reads the links and bodies of a robot with all joints at position 0 (joints that mimic others, at their
/// offset). Meshes are in metres. A file in `package://NAME/…` is searched as NAME/… first in each folder of
/// `package_paths`, then in the folders that contain the URDF file. Throws InputError with file, element and
/// reason.
Scene read_urdf(const std::filesystem::path& path, UrdfGeometry geometry,
                const std::vector<std::filesystem::path>& package_paths);

}  // namespace fringe::cli
