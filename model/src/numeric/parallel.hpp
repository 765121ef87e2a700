#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <mutex>
#include <optional>

namespace fringe::detail {

/// Calls task(k) for k = 0 … count − 1, in any order, on up to so many threads, the calling one among them;
/// 0: as many as this process may run at once. A result that depends on its own k alone has the same bits for
/// any number of threads. The calling thread asks before its own calls, and while it waits for the others,
/// whether it is interrupted; on the other threads check_interruption() then throws, too. What a task throws
/// ends the others and passes through.
void parallel_for(std::size_t count, std::size_t threads, const std::function<void(std::size_t)>& task);

/// Values that are computed when they are first asked for, by whichever thread asks.
template <typename Value, std::size_t size>
class LazyArray {
 public:
  template <typename Make>
  const Value& at(std::size_t index, const Make& make) {
    std::call_once(made_[index], [&] { values_[index].emplace(make()); });
    return *values_[index];
  }

 private:
  std::array<std::once_flag, size> made_;
  std::array<std::optional<Value>, size> values_;
};

}  // namespace fringe::detail
