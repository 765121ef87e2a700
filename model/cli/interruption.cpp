#include "interruption.hpp"

#include <chrono>

#include <fmt/format.h>

#include "program.hpp"

namespace fringe::cli {
namespace {

volatile std::sig_atomic_t was_asked_to_end = 0;
volatile std::sig_atomic_t is_late = 0;

/// Returns the question whether Ctrl-C came, or the time is over.
std::function<bool()> question(std::optional<double> most_seconds) {
  using Clock = std::chrono::steady_clock;
  return [start = Clock::now(), most_seconds] {
    if (most_seconds && std::chrono::duration<double>(Clock::now() - start).count() >= *most_seconds)
      is_late = 1;
    return was_asked_to_end != 0 || is_late != 0;
  };
}

}  // namespace

CommandInterruption::CommandInterruption(std::optional<double> most_seconds)
    : most_seconds_(most_seconds), before_(), scope_(question(most_seconds)) {
  was_asked_to_end = 0;
  is_late = 0;
  struct sigaction action {};
  action.sa_handler = [](int) { was_asked_to_end = 1; };
  action.sa_flags = SA_RESETHAND;
  sigaction(SIGINT, &action, &before_);
}

CommandInterruption::~CommandInterruption() {
  sigaction(SIGINT, &before_, nullptr);
}

std::optional<int> CommandInterruption::status() const {
  if (was_asked_to_end != 0)
    return interrupted;
  return most_seconds_ && is_late != 0 ? std::optional<int>(not_reached) : std::nullopt;
}

std::string CommandInterruption::reason() const {
  return was_asked_to_end != 0 ? "interrupted"
                               : fmt::format("stopped after {:g} s", most_seconds_.value_or(0));
}

}  // namespace fringe::cli
