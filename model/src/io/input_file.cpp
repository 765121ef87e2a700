#include "io/input_file.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <fstream>
#include <system_error>

#include <fmt/format.h>

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

namespace {

constexpr std::string_view spaces = " \t\r\n\v\f";

/// Removes a leading plus sign, which a number in a file may have but std::from_chars does not accept.
std::string_view without_plus(std::string_view word) {
  return word.size() > 1 && word[0] == '+' && word[1] != '-' ? word.substr(1) : word;
}

void append_utf8(std::string& text, std::uint32_t code) {
  constexpr std::uint32_t tail = 0x3F,
                          mark = 0x80;  // Six bits in each further byte, and the bit that marks it.
  if (code < 0x80) {
    text += static_cast<char>(code);
    return;
  }
  const int further = code < 0x800 ? 1 : code < 0x10000 ? 2 : 3;
  constexpr std::array<std::uint32_t, 4> first{0, 0xC0, 0xE0, 0xF0};
  text += static_cast<char>(first[static_cast<std::size_t>(further)] | code >> (6 * further));
  for (int i = further - 1; i >= 0; --i)
    text += static_cast<char>(mark | (code >> (6 * i) & tail));
}

/// Returns a text in UTF-16, which begins with its byte order mark, as UTF-8.
std::string from_utf16(std::string_view content) {
  const bool is_little = content[0] == '\xFF';
  const auto unit = [&](std::size_t at) {
    const auto low = static_cast<unsigned char>(content[is_little ? at : at + 1]);
    const auto high = static_cast<unsigned char>(content[is_little ? at + 1 : at]);
    return static_cast<std::uint32_t>(high) << 8U | low;
  };
  const auto is_surrogate = [](std::uint32_t code, std::uint32_t first) { return (code & 0xFC00U) == first; };
  constexpr std::uint32_t leading = 0xD800, trailing = 0xDC00;
  std::string text;
  bool is_sound = content.size() % 2 == 0;
  for (std::size_t at = 2; is_sound && at < content.size(); at += 2) {
    std::uint32_t code = unit(at);
    if (is_surrogate(code, leading) && at + 2 < content.size() && is_surrogate(unit(at + 2), trailing)) {
      at += 2;
      code = 0x10000 + ((code - leading) << 10U) + (unit(at) - trailing);
    } else if (is_surrogate(code, leading) || is_surrogate(code, trailing)) {
      is_sound = false;
    }
    append_utf8(text, code);
  }
  if (!is_sound)
    throw InputError("is damaged text in UTF-16");
  return text;
}

}  // namespace

std::string plain_text(std::string_view content) {
  constexpr std::string_view mark = "\xEF\xBB\xBF";
  const bool is_utf16 = content.starts_with("\xFF\xFE") || content.starts_with("\xFE\xFF");
  std::string text = is_utf16 ? from_utf16(content) : std::string(content);
  if (text.starts_with(mark))
    text.erase(0, mark.size());
  if (text.find('\n') == std::string::npos)
    std::replace(text.begin(), text.end(), '\r', '\n');
  return text;
}

std::string_view take_line(std::string_view& text) {
  const std::size_t end = std::min(text.find('\n'), text.size());
  const std::string_view line = text.substr(0, end);
  text.remove_prefix(std::min(end + 1, text.size()));
  return line;
}

std::string_view take_word(std::string_view& text) {
  text.remove_prefix(std::min(text.find_first_not_of(spaces), text.size()));
  const std::string_view word = text.substr(0, text.find_first_of(spaces));
  text.remove_prefix(word.size());
  return word;
}

std::string quoted(std::string_view word) {
  constexpr std::size_t longest = 40;
  std::string text = "'";
  for (const char letter : word.substr(0, longest)) {
    if (letter >= ' ' && letter <= '~')
      text += letter;
    else
      text += fmt::format("\\x{:02x}", static_cast<unsigned char>(letter));
  }
  return text + (word.size() > longest ? "…'" : "'");
}

double parse_number(std::string_view word) {
  const std::string_view number = without_plus(word);
  double value = 0;
  const auto [end, error] = std::from_chars(number.data(), number.data() + number.size(), value);
  if (error == std::errc::result_out_of_range)
    throw InputError(fmt::format("holds {}, which is beyond the range of numbers", quoted(word)));
  if (error != std::errc{} || end != number.data() + number.size() || !std::isfinite(value))
    throw InputError(fmt::format("holds {} instead of a finite number", quoted(word)));
  return value;
}

std::int64_t parse_integer(std::string_view word) {
  const std::string_view number = without_plus(word);
  std::int64_t value = 0;
  const auto [end, error] = std::from_chars(number.data(), number.data() + number.size(), value);
  if (error != std::errc{} || end != number.data() + number.size())
    throw InputError(fmt::format("holds {} instead of an integer", quoted(word)));
  return value;
}

}  // namespace fringe::detail
