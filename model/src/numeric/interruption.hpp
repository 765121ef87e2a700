#pragma once

#include <chrono>

#include "fringe/interruption.hpp"

namespace fringe::detail {

/// Throws Interrupted if the thread's InterruptionScope says so. Loops that may take more than some
/// milliseconds call it between their steps; without a scope it costs a nanosecond.
void check_interruption();

/// While it exists, ends what its thread computes after a time, and whenever the scope outside of it does.
class TimeLimit {
 public:
  explicit TimeLimit(double seconds);
  TimeLimit(const TimeLimit&) = delete;
  TimeLimit& operator=(const TimeLimit&) = delete;

  /// Tells whether the time is over.
  bool is_over() const { return seconds_left() <= 0; }
  double seconds_left() const;

  /// Makes sure that so many seconds are left: for what is needed although the time is over.
  void grant(double seconds);

 private:
  std::chrono::steady_clock::time_point start_;
  double seconds_;
  InterruptionScope scope_;
};

}  // namespace fringe::detail
