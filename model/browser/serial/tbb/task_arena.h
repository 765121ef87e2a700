#pragma once

namespace tbb {

/// Runs what it is given on the calling thread.
class task_arena {
 public:
  explicit task_arena(int /*threads*/ = 1) {}

  template <class Task>
  void execute(const Task& task) {
    task();
  }
};

}  // namespace tbb
