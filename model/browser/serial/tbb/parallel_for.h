#pragma once

#include <cstddef>

namespace tbb {

/// The indices from `begin()` up to `end()`, which stay in one part.
template <class Index>
class blocked_range {
 public:
  blocked_range(Index begin, Index end, std::size_t /*grain*/) : begin_(begin), end_(end) {}
  Index begin() const { return begin_; }
  Index end() const { return end_; }

 private:
  Index begin_, end_;
};

template <class Index, class Task>
void parallel_for(const blocked_range<Index>& range, const Task& task) {
  task(range);
}

template <class Index, class Task>
void parallel_for(Index begin, Index end, const Task& task) {
  for (Index k = begin; k < end; ++k)
    task(k);
}

}  // namespace tbb
