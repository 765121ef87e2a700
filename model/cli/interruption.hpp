#pragma once

#include <csignal>
#include <optional>
#include <string>

#include "fringe/interruption.hpp"

namespace fringe::cli {

/// Ends what the command computes at Ctrl-C or after a time, as InterruptionScope does. The second Ctrl-C
/// ends the process. One at a time.
class CommandInterruption {
 public:
  explicit CommandInterruption(std::optional<double> most_seconds);
  ~CommandInterruption();
  CommandInterruption(const CommandInterruption&) = delete;
  CommandInterruption& operator=(const CommandInterruption&) = delete;

  /// Returns the exit status that tells what ended the computation: `interrupted` or `not_reached`; none if
  /// nothing did.
  std::optional<int> status() const;

  /// Says what ended it, for a message.
  std::string reason() const;

 private:
  std::optional<double> most_seconds_;
  struct sigaction before_;
  InterruptionScope scope_;
};

}  // namespace fringe::cli
