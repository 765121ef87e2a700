#include <bit>
#include <cstdint>
#include <cstring>
#include <optional>
#include <string>

#include <fmt/format.h>

#include "fringe/error.hpp"
#include "io/input_file.hpp"
#include "io/mesh_formats.hpp"

namespace fringe::detail {
namespace {

constexpr std::size_t header_size = 84, count_offset = 80, facet_size = 50, corners_offset = 12;

/// Decodes a number stored in little-endian byte order.
template <class Number>
Number little_endian(std::string_view bytes) {
  static_assert(std::endian::native == std::endian::little);
  Number number;
  std::memcpy(&number, bytes.data(), sizeof number);
  return number;
}

/// Returns the number of triangles of a binary file; none for a text file.
std::optional<std::size_t> binary_count(std::string_view content) {
  if (content.size() < header_size)
    return std::nullopt;
  const std::size_t count = little_endian<std::uint32_t>(content.substr(count_offset));
  return content.size() == header_size + count * facet_size ? std::optional(count) : std::nullopt;
}

Triangle binary_facet(std::string_view facet, std::size_t number) {
  Triangle triangle;
  for (std::size_t corner = 0; corner < 3; ++corner)
    for (std::size_t axis = 0; axis < 3; ++axis)
      triangle[corner][static_cast<Eigen::Index>(axis)] =
          little_endian<float>(facet.substr(corners_offset + (3 * corner + axis) * sizeof(float)));
  for (std::size_t corner = 0; corner < 3; ++corner)
    if (!triangle[corner].allFinite())
      throw InputError(fmt::format("vertex {} of face {} is not finite", corner, number));
  return triangle;
}

void expect(std::string_view& text, std::string_view word, std::size_t number) {
  if (const std::string_view found = take_word(text); found != word)
    throw InputError(found.empty()
                         ? fmt::format("ends within facet {}", number)
                         : fmt::format("has {} instead of '{}' in facet {}", quoted(found), word, number));
}

/// Parses a facet whose first word has been removed already. The stored normal is ignored: it follows from
/// the vertices.
Triangle text_facet(std::string_view& text, std::size_t number) {
  expect(text, "normal", number);
  for (int axis = 0; axis < 3; ++axis)
    take_word(text);
  expect(text, "outer", number);
  expect(text, "loop", number);
  Triangle triangle;
  for (Eigen::Vector3d& corner : triangle) {
    expect(text, "vertex", number);
    for (double& coordinate : corner)
      coordinate = parse_number(take_word(text));
  }
  expect(text, "endloop", number);
  expect(text, "endfacet", number);
  return triangle;
}

/// Reads a text file. Several solids in one file form one surface; the rest of a line that begins or ends a
/// solid is its name.
std::vector<Triangle> read_text(std::string_view text) {
  std::vector<Triangle> triangles;
  bool inside = false;
  for (std::string_view word = take_word(text); !word.empty(); word = take_word(text)) {
    if (word == (inside ? "endsolid" : "solid")) {
      inside = !inside;
      take_line(text);
    } else if (inside && word == "facet") {
      triangles.push_back(text_facet(text, triangles.size()));
    } else {
      throw InputError(fmt::format("has an unexpected {} after {} facets", quoted(word), triangles.size()));
    }
  }
  if (inside)
    throw InputError("ends without 'endsolid'");
  return triangles;
}

}  // namespace

MeshContent read_stl(std::string_view content) {
  if (const std::optional<std::size_t> count = binary_count(content)) {
    MeshContent mesh;
    mesh.triangles.reserve(*count);
    for (std::size_t number = 0; number < *count; ++number)
      mesh.triangles.push_back(
          binary_facet(content.substr(header_size + number * facet_size, facet_size), number));
    return mesh;
  }
  const std::string text = plain_text(content);
  std::string_view begin = text;
  if (!take_word(begin).starts_with("solid"))
    throw InputError("is neither text that begins with 'solid' nor binary data of the length that its number "
                     "of triangles requires");
  return {read_text(text), {}};
}

}  // namespace fringe::detail
