#pragma once

#include <cstdint>
#include <string>
#include <string_view>

/// What the readers of mesh files of text have in common.
namespace fringe::detail {

/// Takes the next line off a text; without its end, however long the text still is.
std::string_view take_line(std::string_view& text);

/// Takes the next word off a text; empty when there is none.
std::string_view take_word(std::string_view& text);

/// A word as a message may show it.
std::string shown(std::string_view word);

/// The finite number that a word stands for. Throws InputError when there is something else, or less or more
/// of it.
double decimal(std::string_view word);

/// The whole number that a word stands for, likewise.
std::int64_t whole(std::string_view word);

}  // namespace fringe::detail
