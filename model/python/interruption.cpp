#include "interruption.hpp"

#include <chrono>

#include "fringe/error.hpp"

namespace py = pybind11;

namespace fringe::python {
namespace {

/// Returns a question that never says to end, but throws what an action raises, which it calls some times a
/// second, with Python's lock.
template <typename Action>
std::function<bool()> asked_now_and_then(const Action& action) {
  using Clock = std::chrono::steady_clock;
  /// Time between two calls: short enough for Ctrl-C, long enough not to disturb other threads.
  static constexpr std::chrono::milliseconds pause{50};
  return [action, next = Clock::now() + pause]() mutable {
    if (Clock::now() < next)
      return false;
    const py::gil_scoped_acquire locked;
    action();
    next = Clock::now() + pause;
    return false;
  };
}

}  // namespace

std::function<bool()> signal_handling() {
  return asked_now_and_then([] {
    if (PyErr_CheckSignals() != 0)
      throw py::error_already_set();
  });
}

void AskingScope::enter() {
  if (scope_)
    throw InputError("an InterruptionScope is entered once at a time");
  scope_.emplace(asked_now_and_then([this] { ask_(); }));
}

void add_interruption(py::module_& module) {
  py::class_<AskingScope>(
      module, "InterruptionScope",
      "A context manager that ends what its thread computes: `ask` is called some times a second, and what "
      "it "
      "raises ends the computation. Without one, Ctrl-C ends what the main thread computes, and nothing what "
      "other threads do.")
      .def(py::init<py::function>(), py::arg("ask"))
      .def(
          "__enter__",
          [](AskingScope& self) -> AskingScope& {
            self.enter();
            return self;
          },
          py::return_value_policy::reference)
      .def("__exit__", [](AskingScope& self, const py::args& /*raised*/) { self.exit(); });
}

}  // namespace fringe::python
