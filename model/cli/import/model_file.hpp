#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "fringe/scene.hpp"

namespace fringe::cli {

/// Returns a file's extension in small letters, with its dot.
std::string extension_of(const std::filesystem::path& path);

/// Returns the content of a file. Throws InputError with the reason if it is not there.
std::string content_of(const std::filesystem::path& path);

/// Returns whether a file is COLLADA (.dae), OBJ or 3MF, by its extension.
bool is_model_file(const std::filesystem::path& path);

/// Reads the nodes of a COLLADA, OBJ or 3MF file as links and their triangles as meshes in metres.
/// The upward axis of COLLADA becomes z. Appends remarks to `warnings`. Throws
/// InputError with file, element and reason.
Scene read_model(const std::filesystem::path& path, std::vector<std::string>& warnings);

/// Reads all triangles of such a file in metres, in the file's own axes. Throws InputError with file and
/// reason.
std::vector<Triangle> read_model_triangles(const std::filesystem::path& path,
                                           std::vector<std::string>& warnings);

}  // namespace fringe::cli
