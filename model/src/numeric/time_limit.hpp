#pragma once

#include <chrono>

#include "fringe/interruption.hpp"

namespace fringe::detail {

/// While it exists, ends what its thread computes after a time, and whenever the scope outside of it does.
class TimeLimit {
 public:
  explicit TimeLimit(double seconds);
  TimeLimit(const TimeLimit&) = delete;
  TimeLimit& operator=(const TimeLimit&) = delete;

  /// Tells whether the time is over.
  bool is_over() const { return seconds_left() <= 0; }
  double seconds_left() const;

 private:
  std::chrono::steady_clock::time_point start_;
  double seconds_;
  InterruptionScope scope_;
};

/// While it exists, no TimeLimit outside of it ends anything: for what may be late because it is short. Other
/// scopes do.
class WithoutTimeLimit {
 public:
  WithoutTimeLimit();
  ~WithoutTimeLimit();
  WithoutTimeLimit(const WithoutTimeLimit&) = delete;
  WithoutTimeLimit& operator=(const WithoutTimeLimit&) = delete;

 private:
  bool before_;
};

}  // namespace fringe::detail
