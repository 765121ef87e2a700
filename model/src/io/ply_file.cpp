#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <optional>
#include <string>

#include <fmt/format.h>

#include "fringe/error.hpp"
#include "io/input_file.hpp"
#include "io/mesh_formats.hpp"

namespace fringe::detail {
namespace {

enum class Format { ascii, little_endian, big_endian };
enum class Kind { signed_number, unsigned_number, floating_point };

struct Type {
  Kind kind;
  std::size_t size;  ///< bytes
};

struct Property {
  std::string name;
  Type type;                   ///< type of the value, or of each value of a list
  std::optional<Type> length;  ///< type of a list's length; empty if the property is not a list
};

struct Element {
  std::string name;
  std::uint64_t count;
  std::vector<Property> properties;
};

struct Header {
  std::optional<Format> format;
  std::vector<Element> elements;
};

[[noreturn]] void fail_header(std::string_view reason) {
  throw InputError(fmt::format("the header of the PLY file is damaged: {}", reason));
}
[[noreturn]] void fail_truncated() {
  throw InputError("the PLY file ends before the data its header announces");
}

Type type_named(std::string_view name) {
  using enum Kind;
  struct Named {
    std::string_view short_name, long_name;
    Type type;
  };
  constexpr std::array<Named, 8> types{{{"char", "int8", {signed_number, 1}},
                                        {"uchar", "uint8", {unsigned_number, 1}},
                                        {"short", "int16", {signed_number, 2}},
                                        {"ushort", "uint16", {unsigned_number, 2}},
                                        {"int", "int32", {signed_number, 4}},
                                        {"uint", "uint32", {unsigned_number, 4}},
                                        {"float", "float32", {floating_point, 4}},
                                        {"double", "float64", {floating_point, 8}}}};
  const auto* found = std::find_if(types.begin(), types.end(), [=](const Named& known) {
    return known.short_name == name || known.long_name == name;
  });
  if (found == types.end())
    fail_header(fmt::format("unknown type {}", quoted(name)));
  return found->type;
}

Property read_property(std::string_view words) {
  Property property;
  std::string_view type = take_word(words);
  if (type == "list") {
    property.length = type_named(take_word(words));
    if (property.length->kind == Kind::floating_point)
      fail_header("the length of a list must be an integer");
    type = take_word(words);
  }
  property.type = type_named(type);
  property.name = take_word(words);
  if (property.name.empty() || !take_word(words).empty())
    fail_header("a property needs one name");
  return property;
}

Format read_format(std::string_view words) {
  const std::string_view name = take_word(words), version = take_word(words);
  if (version != "1.0" || !take_word(words).empty())
    fail_header("a format needs a name and the version 1.0");
  if (name == "ascii")
    return Format::ascii;
  if (name == "binary_little_endian")
    return Format::little_endian;
  if (name == "binary_big_endian")
    return Format::big_endian;
  fail_header(fmt::format("unknown format {}", quoted(name)));
}

Element read_element(std::string_view words) {
  const std::string_view name = take_word(words);
  const std::int64_t count = parse_integer(take_word(words));
  if (count < 0 || !take_word(words).empty())
    fail_header("an element needs a name and a count");
  return {std::string(name), static_cast<std::uint64_t>(count), {}};
}

/// Parses the header and removes it from the content.
Header read_header(std::string_view& content) {
  if (const std::string_view first = take_line(content); first != "ply" && first != "ply\r")
    fail_header("it does not begin with 'ply'");
  Header header;
  while (!content.empty()) {
    std::string_view line = take_line(content);
    const std::string_view all = line, keyword = take_word(line);
    if (keyword == "end_header" && take_word(line).empty()) {
      if (!header.format)
        fail_header("the format is missing");
      return header;
    }
    if (keyword.empty() || keyword == "comment" || keyword == "obj_info")
      continue;
    if (keyword == "format" && !header.format)
      header.format = read_format(line);
    else if (keyword == "element")
      header.elements.push_back(read_element(line));
    else if (keyword == "property" && !header.elements.empty())
      header.elements.back().properties.push_back(read_property(line));
    else
      fail_header(fmt::format("unknown line {}", quoted(all)));
  }
  fail_header("end_header is missing");
}

/// Reads the values after the header one by one.
class Values {
 public:
  Values(std::string_view content, Format format) : rest_(content), format_(format) {}

  double number(const Type& type) {
    if (format_ == Format::ascii)
      return parse_number(word());
    if (type.kind != Kind::floating_point)
      return static_cast<double>(integer(type));
    const std::uint64_t bits = take(type.size);
    if (type.size == sizeof(double))
      return std::bit_cast<double>(bits);
    return std::bit_cast<float>(static_cast<std::uint32_t>(bits));
  }

  std::int64_t integer(const Type& type) {
    if (format_ == Format::ascii)
      return parse_integer(word());
    const auto bits = static_cast<std::int64_t>(take(type.size));
    const std::int64_t sign = std::int64_t{1} << (8 * type.size - 1);
    return type.kind == Kind::signed_number && (bits & sign) != 0 ? bits - 2 * sign : bits;
  }

  std::int64_t length(const Property& property) {
    const std::int64_t length = integer(*property.length);
    if (length < 0)
      throw InputError("the PLY file has a list of negative length");
    return length;
  }

  void skip(const Property& property) {
    const std::int64_t count = property.length ? length(property) : 1;
    for (std::int64_t i = 0; i < count; ++i) {
      if (format_ == Format::ascii)
        word();
      else
        take(property.type.size);
    }
  }

 private:
  std::string_view word() {
    const std::string_view found = take_word(rest_);
    if (found.empty())
      fail_truncated();
    return found;
  }

  /// Removes the next value, of up to eight bytes, and returns its bits.
  std::uint64_t take(std::size_t size) {
    if (rest_.size() < size)
      fail_truncated();
    std::uint64_t bits = 0;
    for (std::size_t i = 0; i < size; ++i) {
      const std::size_t place = format_ == Format::little_endian ? i : size - 1 - i;
      bits |= static_cast<std::uint64_t>(static_cast<unsigned char>(rest_[i])) << (8 * place);
    }
    rest_.remove_prefix(size);
    return bits;
  }

  std::string_view rest_;
  Format format_;
};

bool is_vertex_list(const Property& property) {
  return property.length && (property.name == "vertex_indices" || property.name == "vertex_index");
}

/// Finds the only element of a name. Each predicate must hold for exactly one of its properties; `needed`
/// names these properties in the message.
template <class... Predicates>
const Element& only_element(const Header& header, std::string_view name, std::string_view needed,
                            const Predicates&... predicates) {
  const Element* found = nullptr;
  for (const Element& element : header.elements)
    if (element.name == name) {
      if (found != nullptr)
        fail_header(fmt::format("there are two elements {}", name));
      found = &element;
    }
  if (found == nullptr)
    throw InputError(fmt::format("holds no triangles: the PLY file has no element {}", name));
  const auto holds_once = [&](const auto& predicate) {
    return std::count_if(found->properties.begin(), found->properties.end(), predicate) == 1;
  };
  if (!(holds_once(predicates) && ...))
    fail_header(fmt::format("the element {} needs {} exactly once", name, needed));
  return *found;
}

auto coordinate(std::string_view name) {
  return [name](const Property& property) { return property.name == name && !property.length; };
}

std::vector<Eigen::Vector3d> read_vertices(const Element& element, Values& values) {
  std::vector<Eigen::Vector3d> vertices;
  for (std::uint64_t number = 0; number < element.count; ++number) {
    Eigen::Vector3d vertex = Eigen::Vector3d::Zero();
    for (const Property& property : element.properties) {
      const std::size_t axis = std::string_view("xyz").find(property.name);
      if (property.name.size() == 1 && axis < 3 && !property.length)
        vertex[static_cast<Eigen::Index>(axis)] = values.number(property.type);
      else
        values.skip(property);
    }
    if (!vertex.allFinite())
      throw InputError(fmt::format("vertex {} is not finite", number));
    vertices.push_back(vertex);
  }
  return vertices;
}

/// The vertex indices of all faces, checked once all vertices are known, and where each face ends in them.
struct FaceCorners {
  std::vector<std::int64_t> vertices;
  std::vector<std::size_t> ends;
};

void append_corners(FaceCorners& corners, std::uint64_t face, std::int64_t length, const Type& type,
                    Values& values) {
  if (length < 3)
    throw InputError(fmt::format("face {} has fewer than three vertices", face));
  for (std::int64_t i = 0; i < length; ++i)
    corners.vertices.push_back(values.integer(type));
  corners.ends.push_back(corners.vertices.size());
}

FaceCorners read_faces(const Element& element, Values& values) {
  FaceCorners corners;
  for (std::uint64_t face = 0; face < element.count; ++face)
    for (const Property& property : element.properties) {
      if (is_vertex_list(property))
        append_corners(corners, face, values.length(property), property.type, values);
      else
        values.skip(property);
    }
  return corners;
}

void skip_element(const Element& element, Values& values) {
  if (element.properties.empty())
    return;  // occupies no bytes, whatever its count
  for (std::uint64_t i = 0; i < element.count; ++i)
    for (const Property& property : element.properties)
      values.skip(property);
}

MeshContent assemble(const std::vector<Eigen::Vector3d>& vertices, const FaceCorners& corners) {
  MeshContent mesh;
  std::vector<Eigen::Vector3d> face;
  std::size_t begin = 0;
  for (std::size_t number = 0; number < corners.ends.size(); ++number) {
    face.clear();
    for (; begin < corners.ends[number]; ++begin) {
      const std::int64_t vertex = corners.vertices[begin];
      if (vertex < 0 || static_cast<std::size_t>(vertex) >= vertices.size())
        throw InputError(fmt::format("face {} refers to vertex {}; there are {} vertices", number, vertex,
                                     vertices.size()));
      face.push_back(vertices[static_cast<std::size_t>(vertex)]);
    }
    append_face(mesh.triangles, face, mesh.defects);
  }
  return mesh;
}

}  // namespace

MeshContent read_ply(std::string_view content) {
  const Header header = read_header(content);
  const Element& vertex_element = only_element(header, "vertex", "the numbers x, y and z", coordinate("x"),
                                               coordinate("y"), coordinate("z"));
  const Element& face_element = only_element(header, "face", "the list vertex_indices", is_vertex_list);
  for (const Property& property : face_element.properties)
    if (is_vertex_list(property) && property.type.kind == Kind::floating_point)
      fail_header("vertex indices must be integers");
  Values values(content, *header.format);
  std::vector<Eigen::Vector3d> vertices;
  FaceCorners corners;
  for (const Element& element : header.elements) {
    if (&element == &vertex_element)
      vertices = read_vertices(element, values);
    else if (&element == &face_element)
      corners = read_faces(element, values);
    else
      skip_element(element, values);
  }
  return assemble(vertices, corners);
}

}  // namespace fringe::detail
