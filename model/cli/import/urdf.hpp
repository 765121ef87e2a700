#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "fringe/scene.hpp"

namespace fringe::cli {

/// The geometry that is imported from a link.
enum class UrdfGeometry { collision, visual };

/// Reads "collision" or "visual"; throws InputError for anything else.
UrdfGeometry parse_urdf_geometry(const std::string& name);

/// Tells whether a robot with a mesh that is missing or cannot be read is refused, or imported without it.
enum class MissingMesh { refuse, leave_out };

/// Reads "refuse" or "leave-out"; throws InputError for anything else.
MissingMesh parse_missing_mesh(const std::string& name);

/// The part of a robot to import, and the positions of its joints.
struct UrdfRequest {
  UrdfGeometry geometry = UrdfGeometry::collision;
  MissingMesh missing = MissingMesh::refuse;
  std::vector<std::filesystem::path> package_paths;  ///< searched first for packages
  std::map<std::string, double> joints;              ///< positions by name, rad or m; 0 for all others
};

/// Reads the links, joints and bodies of a robot. Joints that mimic others follow them. Meshes are in metres.
/// A file in `package://NAME/…` is searched as NAME/… first in each folder of `package_paths`, then in the
/// folders that contain the URDF file, where the package's folder may also have another name. What is missing
/// but not needed, what has no size, and positions beyond the limits, are appended to `warnings` with file
/// and element. Throws InputError with file, element and reason.
Scene read_urdf(const std::filesystem::path& path, const UrdfRequest& request,
                std::vector<std::string>& warnings);

}  // namespace fringe::cli
