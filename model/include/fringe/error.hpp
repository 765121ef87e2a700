#pragma once

#include <stdexcept>
#include <string>

namespace fringe {

/// The caller's input is wrong: a scene file, a mesh, a triangle, a method. The message says which element
/// and why; for a scene file it reads "FILE:LINE: KEY: REASON". It is always one line: characters that
/// control a terminal are written as escapes, and the middle of a text too long to read is omitted.
class InputError : public std::runtime_error {
 public:
  explicit InputError(const std::string& message);
};

}  // namespace fringe
