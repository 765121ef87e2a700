#include "obj_indices.hpp"

#include <algorithm>
#include <charconv>
#include <cstddef>
#include <fstream>
#include <sstream>
#include <string>

#include <fmt/format.h>

#include "fringe/error.hpp"

namespace fringe::detail {
namespace {

/// Goes through a file statement by statement; a backslash at the end of a line continues it on the next.
class Statements {
 public:
  explicit Statements(const std::filesystem::path& path) : file_(path, std::ios::binary) {}

  bool next(std::string& statement) {
    statement.clear();
    std::string text;
    first_line_ = line_ + 1;
    while (std::getline(file_, text)) {
      ++line_;
      if (text.ends_with('\r'))
        text.pop_back();
      if (!text.ends_with('\\')) {
        statement += text;
        return true;
      }
      text.back() = ' ';
      statement += text;
    }
    return !statement.empty();
  }

  /// The line on which the current statement begins, from 1.
  std::size_t first_line() const { return first_line_; }

 private:
  std::ifstream file_;
  std::size_t line_ = 0;
  std::size_t first_line_ = 0;
};

long count_vertices(const std::filesystem::path& path) {
  Statements statements(path);
  long count = 0;
  for (std::string statement; statements.next(statement);) {
    std::string keyword;
    std::istringstream(statement) >> keyword;
    count += keyword == "v";
  }
  return count;
}

/// Whether a corner of a face, as in 3, 3/1, 3//2 or -1/1/2, names one of the vertices: by number from 1, or
/// backwards from the last one before the face.
bool names_vertex(const std::string& corner, long vertices_before, long vertices) {
  long index = 0;
  const char* end = corner.data() + std::min(corner.find('/'), corner.size());
  const auto [stop, error] = std::from_chars(corner.data(), end, index);
  return error == std::errc{} && stop == end &&
         (index > 0 ? index <= vertices : index < 0 && -index <= vertices_before);
}

}  // namespace

void require_obj_indices(const std::filesystem::path& path) {
  const long vertices = count_vertices(path);
  Statements statements(path);
  long vertices_before = 0;
  std::size_t face = 0;
  for (std::string statement; statements.next(statement);) {
    std::istringstream words(statement);
    std::string keyword;
    words >> keyword;
    vertices_before += keyword == "v";
    if (keyword != "f")
      continue;
    for (std::string corner; words >> corner && !corner.starts_with('#');)
      if (!names_vertex(corner, vertices_before, vertices))
        throw InputError(fmt::format("face {} (line {}) names vertex {} of {}", face, statements.first_line(),
                                     corner, vertices));
    ++face;
  }
}

}  // namespace fringe::detail
