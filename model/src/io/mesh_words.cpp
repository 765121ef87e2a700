#include "io/mesh_words.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>

#include <fmt/format.h>

#include "fringe/error.hpp"

namespace fringe::detail {
namespace {

constexpr std::string_view spaces = " \t\r\n\v\f";

/// Removes a leading plus sign, which a number in a file may have but std::from_chars does not accept.
std::string_view without_plus(std::string_view word) {
  return word.size() > 1 && word[0] == '+' && word[1] != '-' ? word.substr(1) : word;
}

}  // namespace

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
