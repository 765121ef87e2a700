#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "fringe/scene.hpp"

namespace fringe::cli {

/// Reads a 3MF file with this content: the items of its build and their components are links, and their
/// meshes bodies in metres. Components may be in other models of the archive. What supports the print, or is
/// there for something else, is left out, which is appended to `warnings`. Throws InputError with element and
/// reason.
Scene read_three_mf(const std::filesystem::path& path, std::string content,
                    std::vector<std::string>& warnings);

}  // namespace fringe::cli
