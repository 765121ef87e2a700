#include <string>

#include <fmt/format.h>

#include "fringe/error.hpp"
#include "io/mesh_formats.hpp"
#include "io/mesh_words.hpp"

namespace fringe::detail {
namespace {

/// Iterates over the statements of a file; a backslash at the end of a line continues the statement on the
/// next line.
class Statements {
 public:
  explicit Statements(std::string_view content) : rest_(content) {}

  bool next(std::string& statement) {
    statement.clear();
    first_line_ = line_ + 1;
    while (!rest_.empty()) {
      ++line_;
      std::string_view text = take_line(rest_);
      if (text.ends_with('\r'))
        text.remove_suffix(1);
      if (!text.ends_with('\\')) {
        statement += text;
        return true;
      }
      statement += text.substr(0, text.size() - 1);
      statement += ' ';
    }
    return !statement.empty();
  }

  /// Returns the line on which the current statement begins, counted from 1.
  std::size_t first_line() const { return first_line_; }

 private:
  std::string_view rest_;
  std::size_t line_ = 0;
  std::size_t first_line_ = 0;
};

std::vector<std::string_view> words_of(std::string_view statement) {
  std::vector<std::string_view> words;
  for (std::string_view word = take_word(statement); !word.empty() && !word.starts_with('#');
       word = take_word(statement))
    words.push_back(word);
  return words;
}

struct FaceCorner {
  std::size_t vertex;  ///< index, from 0
  std::size_t line;
  std::size_t face;
};

[[noreturn]] void fail_vertex(const FaceCorner& corner, std::string_view word, std::size_t vertices) {
  throw InputError(fmt::format("face {} (line {}) refers to vertex {}; there are {} vertices", corner.face,
                               corner.line, word, vertices));
}

/// Parses a corner of a face, such as 3, 3/1, 3//2 or -1/1/2. A positive number is a vertex number counted
/// from 1; a negative one counts backwards from the last vertex before the face.
FaceCorner read_corner(std::string_view word, std::size_t vertices, std::size_t line, std::size_t face) {
  const std::int64_t number = parse_integer(word.substr(0, word.find('/')));
  FaceCorner corner{static_cast<std::size_t>(number - 1), line, face};
  if (number == 0 || (number < 0 && -(number + 1) >= static_cast<std::int64_t>(vertices)))
    fail_vertex(corner, word, vertices);
  if (number < 0)
    corner.vertex = vertices - static_cast<std::size_t>(-(number + 1)) - 1;
  return corner;
}

Eigen::Vector3d read_vertex(const std::vector<std::string_view>& words, std::size_t line) {
  // Three coordinates, to which some programs append a colour.
  if (words.size() != 4 && words.size() != 7)
    throw InputError(fmt::format("has a vertex of {} coordinates in line {}", words.size() - 1, line));
  return {parse_number(words[1]), parse_number(words[2]), parse_number(words[3])};
}

}  // namespace

std::vector<Triangle> read_obj(std::string_view content) {
  std::vector<Eigen::Vector3d> vertices;
  // Three per triangle. They are resolved at the end, because faces may refer to vertices that are defined
  // later.
  std::vector<FaceCorner> corners;
  std::size_t faces = 0;
  Statements statements(content);
  for (std::string statement; statements.next(statement);) {
    const std::vector<std::string_view> words = words_of(statement);
    const std::size_t line = statements.first_line();
    if (words.empty())
      continue;
    if (words[0] == "v")
      vertices.push_back(read_vertex(words, line));
    if (words[0] != "f")
      continue;
    if (words.size() < 4)
      throw InputError(fmt::format("face {} (line {}) has fewer than three vertices", faces, line));
    const FaceCorner first = read_corner(words[1], vertices.size(), line, faces);
    for (std::size_t i = 2; i + 1 < words.size(); ++i) {
      corners.push_back(first);
      corners.push_back(read_corner(words[i], vertices.size(), line, faces));
      corners.push_back(read_corner(words[i + 1], vertices.size(), line, faces));
    }
    ++faces;
  }
  std::vector<Triangle> triangles(corners.size() / 3);
  for (std::size_t i = 0; i < corners.size(); ++i) {
    if (corners[i].vertex >= vertices.size())
      fail_vertex(corners[i], std::to_string(corners[i].vertex + 1), vertices.size());
    triangles[i / 3][i % 3] = vertices[corners[i].vertex];
  }
  return triangles;
}

}  // namespace fringe::detail
