#include "ply_completeness.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdint>
#include <fstream>
#include <optional>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include "fringe/error.hpp"

namespace fringe::detail {
namespace {

enum class Format { ascii, little_endian, big_endian };

struct Property {
  int size;                       ///< bytes of the value, or of each value of a list
  std::optional<int> count_size;  ///< bytes of a list's length; none: not a list
};

struct Element {
  std::uint64_t count;
  std::vector<Property> properties;
};

struct Header {
  Format format = Format::ascii;
  std::vector<Element> elements;
};

[[noreturn]] void fail_header() {
  throw InputError("the header of the PLY file is damaged");
}
[[noreturn]] void fail_truncated() {
  throw InputError("the PLY file ends before the data its header announces");
}

int size_of_type(std::string_view type) {
  struct Type {
    std::string_view name;
    int size;
  };
  constexpr std::array<Type, 16> types{{{"char", 1},
                                        {"int8", 1},
                                        {"uchar", 1},
                                        {"uint8", 1},
                                        {"short", 2},
                                        {"int16", 2},
                                        {"ushort", 2},
                                        {"uint16", 2},
                                        {"int", 4},
                                        {"int32", 4},
                                        {"uint", 4},
                                        {"uint32", 4},
                                        {"float", 4},
                                        {"float32", 4},
                                        {"double", 8},
                                        {"float64", 8}}};
  const auto* found =
      std::find_if(types.begin(), types.end(), [=](const Type& known) { return known.name == type; });
  if (found == types.end())
    fail_header();
  return found->size;
}

Property read_property(std::istringstream& words) {
  std::string type;
  words >> type;
  if (type != "list")
    return {size_of_type(type), std::nullopt};
  std::string count_type, value_type;
  words >> count_type >> value_type;
  return {size_of_type(value_type), size_of_type(count_type)};
}

Format read_format(std::istringstream& words) {
  std::string name;
  words >> name;
  if (name == "ascii")
    return Format::ascii;
  if (name == "binary_little_endian")
    return Format::little_endian;
  if (name == "binary_big_endian")
    return Format::big_endian;
  fail_header();
}

Header read_header(std::istream& file) {
  Header header;
  std::string line;
  while (std::getline(file, line)) {
    std::istringstream words(line);
    std::string keyword;
    words >> keyword;
    if (keyword == "end_header")
      return header;
    if (keyword == "format") {
      header.format = read_format(words);
    } else if (keyword == "element") {
      Element element{};
      std::string name;
      if (!(words >> name >> element.count))
        fail_header();
      header.elements.push_back(element);
    } else if (keyword == "property") {
      if (header.elements.empty())
        fail_header();
      header.elements.back().properties.push_back(read_property(words));
    }
  }
  fail_header();
}

double next_number(std::istream& file) {
  std::string word;
  if (!(file >> word))
    fail_truncated();
  double value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc{} || end != word.data() + word.size())
    throw InputError("the PLY file holds a word where a number belongs");
  return value;
}

void skip_ascii(std::istream& file, const Property& property) {
  const double count = property.count_size ? next_number(file) : 1;
  for (double i = 0; i < count; ++i)
    next_number(file);
}

/// The length of a list, stored in one, two or four bytes.
std::uint32_t read_count(std::istream& file, int size, Format format) {
  std::uint32_t count = 0;
  for (int i = 0; i < size; ++i) {
    const int byte = file.get();
    if (byte == std::istream::traits_type::eof())
      fail_truncated();
    const int place = format == Format::little_endian ? i : size - 1 - i;
    count |= static_cast<std::uint32_t>(byte) << (8 * place);
  }
  return count;
}

void skip_binary(std::istream& file, const Property& property, Format format) {
  const std::uint32_t count = property.count_size ? read_count(file, *property.count_size, format) : 1;
  const auto bytes = static_cast<std::streamsize>(count) * property.size;
  file.ignore(bytes);
  if (file.gcount() != bytes)
    fail_truncated();
}

}  // namespace

void require_complete_ply(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  const Header header = read_header(file);
  for (const Element& element : header.elements) {
    if (element.properties.empty())
      continue;  // takes no bytes, however many there are said to be
    for (std::uint64_t i = 0; i < element.count; ++i)
      for (const Property& property : element.properties) {
        if (header.format == Format::ascii)
          skip_ascii(file, property);
        else
          skip_binary(file, property, header.format);
      }
  }
}

}  // namespace fringe::detail
