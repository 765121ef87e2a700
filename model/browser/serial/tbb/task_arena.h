#pragma once

namespace tbb {

/// Runs what it is given on the calling thread.
class task_arena {
 public:
  template <class Task>
  void execute(const Task& task) {
    task();
  }
};

}  // namespace tbb
