#pragma once

#include <functional>
#include <stdexcept>

namespace fringe {

/// A computation ended because it was asked to, before it had an answer.
class Interrupted : public std::runtime_error {
 public:
  Interrupted();
};

/// While it exists, what takes long, on the thread that made it, asks a function many times a second whether
/// to end. It does when that returns true, which it must then do for good: maxwell() returns the best matrix
/// so far with its estimated errors, everything else throws Interrupted. What the function throws passes
/// through. A scope within another one asks that one's function, too.
class InterruptionScope {
 public:
  explicit InterruptionScope(std::function<bool()> is_to_end);
  ~InterruptionScope();
  InterruptionScope(const InterruptionScope&) = delete;
  InterruptionScope& operator=(const InterruptionScope&) = delete;

 private:
  std::function<bool()> is_to_end_;
  const std::function<bool()>* outer_;
};

}  // namespace fringe
