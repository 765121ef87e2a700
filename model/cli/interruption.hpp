#pragma once

#include <csignal>

#include "fringe/interruption.hpp"

namespace fringe::cli {

/// Ends what the command computes at Ctrl-C, as InterruptionScope does. The second Ctrl-C ends the process.
/// One at a time.
class CommandInterruption {
 public:
  CommandInterruption();
  ~CommandInterruption();
  CommandInterruption(const CommandInterruption&) = delete;
  CommandInterruption& operator=(const CommandInterruption&) = delete;

  /// Tells whether Ctrl-C was pressed.
  bool is_asked_for() const;

 private:
  struct sigaction before_;
  InterruptionScope scope_;
};

}  // namespace fringe::cli
