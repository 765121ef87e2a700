#pragma once

#include <filesystem>
#include <string>

namespace fringe::detail {

/// Whether a path leads to a regular file: no folder, no device, no pipe, which could take for ever to read.
/// A path that no file can have, of a loop of links for instance, leads to none.
bool is_file(const std::filesystem::path& path);

/// The bytes of a file. Throws InputError when it cannot be read.
std::string file_content(const std::filesystem::path& path);

}  // namespace fringe::detail
