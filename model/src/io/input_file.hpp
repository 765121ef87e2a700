#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace fringe::detail {

/// Returns whether a path leads to a regular file. Folders, devices and pipes, which could take forever to
/// read, are not regular files. A path that cannot be resolved, such as a loop of links, leads to none.
bool is_file(const std::filesystem::path& path);

/// Reads the bytes of a file. Throws InputError when it cannot be read.
std::string file_content(const std::filesystem::path& path);

/// Throws InputError if a file's content is not there: for an empty one, one of zeros, and for a pointer of
/// Git LFS, which stands for a file that was not fetched.
void require_content(std::string_view content);

}  // namespace fringe::detail
