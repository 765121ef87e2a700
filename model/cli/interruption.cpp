#include "interruption.hpp"

namespace fringe::cli {
namespace {

volatile std::sig_atomic_t was_asked_to_end = 0;

}  // namespace

CommandInterruption::CommandInterruption() : before_(), scope_([] { return was_asked_to_end != 0; }) {
  was_asked_to_end = 0;
  struct sigaction action {};
  action.sa_handler = [](int) { was_asked_to_end = 1; };
  action.sa_flags = SA_RESETHAND;
  sigaction(SIGINT, &action, &before_);
}

CommandInterruption::~CommandInterruption() {
  sigaction(SIGINT, &before_, nullptr);
}

// Only an object that listens can tell.
// NOLINTNEXTLINE(readability-convert-member-functions-to-static)
bool CommandInterruption::is_asked_for() const {
  return was_asked_to_end != 0;
}

}  // namespace fringe::cli
