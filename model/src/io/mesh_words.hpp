#pragma once

#include <cstdint>
#include <string>
#include <string_view>

/// Functions that the readers of text mesh files share.
namespace fringe::detail {

/// Returns a text in UTF-8 without a byte order mark, whose lines end in a line feed. It may be given in
/// UTF-16, or with carriage returns only.
std::string plain_text(std::string_view content);

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
