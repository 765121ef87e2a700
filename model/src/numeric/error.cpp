#include "fringe/error.hpp"

#include <cstddef>

#include <fmt/format.h>

namespace fringe {
namespace {

/// Length in bytes above which a message is shortened: room for the longest path of the system and a sentence
/// about it.
constexpr std::size_t longest = 6000;

/// Returns whether a byte continues a UTF-8 character, which must not be cut in two.
bool continues(char byte) {
  return (static_cast<unsigned char>(byte) & 0xC0U) == 0x80;
}

/// Replaces the middle of an overlong text by an ellipsis.
std::string shortened(const std::string& text) {
  if (text.size() <= longest)
    return text;
  std::size_t head = longest / 2, tail = text.size() - longest / 2;
  while (head > 0 && continues(text[head]))
    --head;
  while (tail < text.size() && continues(text[tail]))
    ++tail;
  return text.substr(0, head) + " … " + text.substr(tail);
}

/// Escapes control characters, so that the message fits on one line.
std::string one_line(const std::string& text) {
  constexpr char last_control = 0x1F, erasure = 0x7F;
  std::string line;
  for (const char letter : text) {
    if (letter == '\n')
      line += "\\n";
    else if ((letter >= 0 && letter <= last_control) || letter == erasure)
      line += fmt::format("\\x{:02x}", letter);
    else
      line += letter;
  }
  return line;
}

}  // namespace

InputError::InputError(const std::string& message) : std::runtime_error(shortened(one_line(message))) {}

}  // namespace fringe
