#pragma once

#include <filesystem>

namespace fringe::detail {

/// Throws InputError unless a PLY file holds everything its header announces. Assimp's reader fills what is
/// missing from a truncated file with whatever it finds in memory.
void require_complete_ply(const std::filesystem::path& path);

}  // namespace fringe::detail
