#pragma once

#include <algorithm>
#include <cstddef>
#include <ctime>
#include <limits>
#include <vector>

namespace fringe::benchmarks {

/// Returns the processor time of this thread in s, which others on the machine do not lengthen.
inline double processor_seconds() {
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

/// Returns the processor time of an action in s.
template <typename Action>
double seconds_of(const Action& action) {
  const double start = processor_seconds();
  action();
  return processor_seconds() - start;
}

/// Returns the least processor time in s of an action that is repeated.
template <typename Action>
double least_seconds_of(const Action& action, int repeats = 5) {
  double least = std::numeric_limits<double>::infinity();
  for (int repeat = 0; repeat < repeats; ++repeat)
    least = std::min(least, seconds_of(action));
  return least;
}

/// Returns the value below which a part of all values is.
inline double quantile(std::vector<double> values, double part) {
  std::sort(values.begin(), values.end());
  return values[std::min(values.size() - 1,
                         static_cast<std::size_t>(part * static_cast<double>(values.size())))];
}

}  // namespace fringe::benchmarks
