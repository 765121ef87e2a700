#include <algorithm>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "fringe/error.hpp"
#include "io/input_file.hpp"
#include "io/mesh_formats.hpp"

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

/// Reads a vertex of three coordinates, to which a weight or, by some programs, a colour may be added.
Eigen::Vector3d read_vertex(const std::vector<std::string_view>& words, std::size_t line) {
  if (words.size() != 4 && words.size() != 5 && words.size() != 7)
    throw InputError(fmt::format("has a vertex of {} coordinates in line {}", words.size() - 1, line));
  try {
    if (words.size() == 5 && parse_number(words[4]) != 1)
      throw InputError(fmt::format("has a vertex of the weight {}; only 1 is read", quoted(words[4])));
    return {parse_number(words[1]), parse_number(words[2]), parse_number(words[3])};
  } catch (const InputError& error) {
    throw InputError(fmt::format("{} in line {}", error.what(), line));
  }
}

/// What an OBJ file says. Corners of a face follow each other. They are looked up last, because faces may
/// refer to vertices that are defined later.
struct ObjContent {
  std::vector<Eigen::Vector3d> vertices;
  std::vector<FaceCorner> corners;
  std::vector<std::size_t> bodies;     ///< of the faces: indices of the names
  std::vector<std::string> names{""};  ///< of objects and groups; that of faces before any is empty
};

/// Returns the index of the object or group that a statement begins or goes on with.
std::size_t body_named(const std::vector<std::string_view>& words, std::vector<std::string>& names) {
  std::string name;
  for (std::size_t i = 1; i < words.size(); ++i)
    name += (i > 1 ? " " : "") + std::string(words[i]);
  const auto known = std::find(names.begin(), names.end(), name);
  const auto index = static_cast<std::size_t>(known - names.begin());
  if (known == names.end())
    names.push_back(std::move(name));
  return index;
}

ObjContent parse_obj(std::string_view content) {
  const std::string text = plain_text(content);
  ObjContent parsed;
  std::size_t body = 0;
  Statements statements(text);
  for (std::string statement; statements.next(statement);) {
    const std::vector<std::string_view> words = words_of(statement);
    const std::size_t line = statements.first_line(), face = parsed.bodies.size();
    if (words.empty())
      continue;
    if (words[0] == "v")
      parsed.vertices.push_back(read_vertex(words, line));
    if (words[0] == "o" || words[0] == "g")
      body = body_named(words, parsed.names);
    if (words[0] != "f")
      continue;
    if (words.size() < 4)
      throw InputError(fmt::format("face {} (line {}) has fewer than three vertices", face, line));
    for (std::size_t i = 1; i < words.size(); ++i)
      parsed.corners.push_back(read_corner(words[i], parsed.vertices.size(), line, face));
    parsed.bodies.push_back(body);
  }
  return parsed;
}

/// Divides the faces in their order; `mesh_of` returns the mesh of a body's index.
template <class MeshOf>
void divide(const ObjContent& parsed, const MeshOf& mesh_of) {
  std::vector<Eigen::Vector3d> face;
  for (std::size_t i = 0; i < parsed.corners.size(); ++i) {
    const FaceCorner& corner = parsed.corners[i];
    if (corner.vertex >= parsed.vertices.size())
      fail_vertex(corner, std::to_string(corner.vertex + 1), parsed.vertices.size());
    face.push_back(parsed.vertices[corner.vertex]);
    if (i + 1 < parsed.corners.size() && parsed.corners[i + 1].face == corner.face)
      continue;
    MeshContent& mesh = mesh_of(parsed.bodies[corner.face]);
    append_face(mesh.triangles, face, mesh.defects);
    face.clear();
  }
}

}  // namespace

MeshContent read_obj(std::string_view content) {
  MeshContent mesh;
  divide(parse_obj(content), [&](std::size_t) -> MeshContent& { return mesh; });
  return mesh;
}

std::vector<NamedMesh> read_obj_bodies(std::string_view content) {
  const ObjContent parsed = parse_obj(content);
  std::vector<NamedMesh> bodies;
  for (const std::string& name : parsed.names)
    bodies.push_back({name, {}});
  divide(parsed, [&](std::size_t body) -> MeshContent& { return bodies[body].mesh; });
  return bodies;
}

}  // namespace fringe::detail
