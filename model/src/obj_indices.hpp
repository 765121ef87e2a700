#pragma once

#include <filesystem>

namespace fringe::detail {

/// Throws InputError, with the number of the face and its line, when a face of an OBJ file names a vertex
/// that does not exist. What else may be wrong with the file is left to its reader.
void require_obj_indices(const std::filesystem::path& path);

}  // namespace fringe::detail
