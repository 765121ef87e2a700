#pragma once

#include <functional>
#include <optional>
#include <utility>

#include <pybind11/pybind11.h>

#include "fringe/interruption.hpp"

namespace fringe::python {

/// Returns a question for an InterruptionScope that lets Python handle the signals that came, some times a
/// second. It never says to end, but throws what their handlers raise: KeyboardInterrupt after Ctrl-C.
std::function<bool()> signal_handling();

/// A context manager that ends what its thread computes: a function of Python is called some times a second,
/// and what it raises passes through. Signals are handled on the main thread only; this is for the others.
class AskingScope {
 public:
  explicit AskingScope(pybind11::function ask) : ask_(std::move(ask)) {}

  /// Both on the same thread.
  void enter();
  void exit() { scope_.reset(); }

 private:
  pybind11::function ask_;
  std::optional<InterruptionScope> scope_;
};

/// Adds the class to the module.
void add_interruption(pybind11::module_& module);

}  // namespace fringe::python
