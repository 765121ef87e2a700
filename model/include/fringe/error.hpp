#pragma once

#include <stdexcept>

namespace fringe {

/// What the caller gave is wrong: a scene file, a mesh, a triangle, a method. The message says which element
/// and why; for a scene file it reads "FILE:LINE: KEY: REASON".
class InputError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace fringe
