#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace fringe::cli {

/// Returns the text of a robot without what the parser refuses and no scene needs: materials, inertias,
/// dynamics, the geometry that is not `taken` (the name of its element), and limits but those of positions.
/// Each part that is missing or wrong is appended to `warnings` with file and element. Throws InputError,
/// with file and reason, for what is to be expanded by xacro, and for links that form no tree.
std::string simplified_urdf(const std::filesystem::path& path, const std::string& taken,
                            std::vector<std::string>& warnings);

}  // namespace fringe::cli
