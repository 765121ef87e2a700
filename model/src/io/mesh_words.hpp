#pragma once

#include <cstdint>
#include <string>
#include <string_view>

/// Functions that the readers of text mesh files share.
namespace fringe::detail {

/// Removes the next line from a text and returns it without its line end.
std::string_view take_line(std::string_view& text);

/// Removes the next word from a text and returns it; empty when there is none.
std::string_view take_word(std::string_view& text);

/// Quotes a word for a message: shortened, and with everything but printable ASCII escaped.
std::string quoted(std::string_view word);

/// Parses a word as a finite number. Throws InputError unless the whole word is one.
double parse_number(std::string_view word);

/// Parses a word as an integer. Throws InputError unless the whole word is one.
std::int64_t parse_integer(std::string_view word);

}  // namespace fringe::detail
