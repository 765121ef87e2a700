#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace fringe::cli {

/// What `fringe import` is asked for.
struct ImportRequest {
  std::filesystem::path source;
  std::filesystem::path target;
  std::string geometry = "collision";
  std::vector<std::filesystem::path> package_paths;
  bool about_urdf = false;  ///< whether an option was given that is about URDF only
};

/// Writes the scene file that a robot or a model makes, and mesh files beside it; returns a line on what was
/// written. Throws InputError, with nothing written, when the source cannot be used.
std::string import_scene(const ImportRequest& request);

}  // namespace fringe::cli
