#pragma once

#include <array>
#include <cstddef>
#include <mutex>
#include <optional>

namespace fringe::detail {

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
