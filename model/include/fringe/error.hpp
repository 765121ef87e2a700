#pragma once

#include <stdexcept>
#include <string>

namespace fringe {

/// What the caller gave is wrong: a scene file, a mesh, a triangle, a method. The message says which element
/// and why; for a scene file it reads "FILE:LINE: KEY: REASON". It is one line, whatever it names: characters
/// that control a terminal are written out, and the middle of what is too long to be read is left out.
class InputError : public std::runtime_error {
 public:
  explicit InputError(const std::string& message);
};

}  // namespace fringe
