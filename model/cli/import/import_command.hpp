#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace fringe::cli {

/// The arguments of `fringe import`.
struct ImportRequest {
  std::filesystem::path source;
  std::filesystem::path target;
  std::string geometry = "collision";
  std::vector<std::filesystem::path> package_paths;
  bool about_urdf = false;  ///< whether an option was given that applies to URDF only
};

/// Imports a robot or a model: writes a scene file, and mesh files beside it, and returns a line that says
/// what was written. Throws InputError, with nothing written, when the source cannot be used.
std::string import_scene(const ImportRequest& request);

}  // namespace fringe::cli
