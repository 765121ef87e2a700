#pragma once

#include <filesystem>
#include <optional>

#include "fringe/scene.hpp"

namespace fringe::cli {

/// The triangles of a STEP file, and how far they are from its surfaces.
struct StepImport {
  Scene scene;
  double deflection;  ///< m, the distance that was asked for
  double error;       ///< m, the largest distance measured: at the middle of every edge and triangle
};

/// The part of the diagonal of the bounding box that is asked for as deflection where nothing else is asked
/// for.
constexpr double default_deflection = 1e-3;

/// Reads a STEP file by OpenCASCADE: assemblies and parts are links, solids are meshes in metres with the
/// names that the file gives them. Faces with names are meshes of their own, one for all faces of a part with
/// the same name. `deflection` (m) is the distance that triangles may have from the surface. Throws
/// InputError with file and reason.
StepImport read_step(const std::filesystem::path& path, std::optional<double> deflection);

}  // namespace fringe::cli
