#pragma once

namespace tbb {

/// Runs its tasks at once on the calling thread.
class task_group {
 public:
  template <class Task>
  void run(const Task& task) {
    task();
  }
  void wait() {}
};

}  // namespace tbb
