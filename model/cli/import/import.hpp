#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace fringe::cli {

/// The arguments of `fringe import`. Those that are given must apply to the source's format.
struct ImportRequest {
  std::filesystem::path source;
  std::filesystem::path target;
  std::optional<std::string> geometry;               ///< of URDF: collision (default) or visual
  std::optional<std::string> missing;                ///< of URDF: refuse (default) or leave-out
  std::vector<std::filesystem::path> package_paths;  ///< of URDF
  std::vector<std::string> joints;                   ///< of URDF: lists NAME=POSITION,…; rad or m
  std::optional<double> deflection;                  ///< of STEP: m
};

/// The result of an import: a sentence about the files written, and the warnings, a line each.
struct ImportReport {
  std::string written;
  std::vector<std::string> warnings;
};

/// Imports a robot or a model: writes a scene file, and mesh files beside it. Throws InputError, with nothing
/// written, when the source cannot be used.
ImportReport import_scene(const ImportRequest& request);

}  // namespace fringe::cli
