#include "io/input_file.hpp"

#include <fstream>
#include <system_error>

#include "fringe/error.hpp"

namespace fringe::detail {

bool is_file(const std::filesystem::path& path) {
  // The system's functions would end the path at a NUL character.
  std::error_code error;
  return path.native().find('\0') == std::string::npos && std::filesystem::is_regular_file(path, error);
}

std::string file_content(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary | std::ios::ate);
  std::string content(file ? static_cast<std::size_t>(file.tellg()) : 0, '\0');
  file.seekg(0);
  file.read(content.data(), static_cast<std::streamsize>(content.size()));
  if (!file)
    throw InputError("the file cannot be opened or read");
  return content;
}

void require_content(std::string_view content) {
  if (content.empty())
    throw InputError("it is empty");
  if (content.find_first_not_of('\0') == std::string_view::npos)
    throw InputError("it holds nothing but zeros");
  if (content.starts_with("version https://git-lfs.github.com/spec/"))
    throw InputError("it is a pointer of Git LFS, whose content has to be fetched: git lfs pull");
}

}  // namespace fringe::detail
