#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

/// Input files: their content, and the lines, words and numbers of those that are text.
namespace fringe::detail {

/// Returns whether a path leads to a regular file. Folders, devices and pipes, which could take forever to
/// read, are not regular files. A path that cannot be resolved, such as a loop of links, leads to none.
bool is_file(const std::filesystem::path& path);

/// Reads the bytes of a file. Throws InputError when it cannot be read.
std::string file_content(const std::filesystem::path& path);

/// Throws InputError if a file's content is not there: for an empty one, one of zeros, and for a pointer of
/// Git LFS, which stands for a file that was not fetched.
void require_content(std::string_view content);

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
