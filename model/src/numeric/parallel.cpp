#include "numeric/parallel.hpp"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <exception>
#include <memory>
#include <mutex>
#include <utility>
#include <vector>

#include <tbb/info.h>
#include <tbb/task_arena.h>
#include <tbb/task_group.h>

#include "fringe/interruption.hpp"
#include "numeric/interruption.hpp"

#if defined(__has_feature)
#if __has_feature(thread_sanitizer)
#define FRINGE_THREAD_SANITIZER
#endif
#endif
#ifdef FRINGE_THREAD_SANITIZER
#include <sanitizer/tsan_interface.h>
#endif

namespace fringe::detail {
namespace {

/// Number of threads that a loop may use; 0: all.
std::size_t threads_of(std::size_t threads) {
  const auto offered = static_cast<std::size_t>(tbb::info::default_concurrency());
  return threads == 0 ? offered : std::min(threads, offered);
}

/// Tells clang's thread sanitizer how oneTBB orders a parallel loop, which the tool cannot see because the
/// library is compiled without it: everything before the loop happens before every part of its body, and
/// every part of the body before everything after the loop. Two parts of the body are not ordered.
class LoopOrder {
 public:
  LoopOrder() { release(&start_); }

  /// Must be called first in a part of the body.
  void part_begins() const { acquire(&start_); }
  /// Must be called last in a part of the body.
  void part_ends() const { release(&end_); }
  /// Must be called after the loop has returned.
  void loop_ended() const { acquire(&end_); }

 private:
#ifdef FRINGE_THREAD_SANITIZER
  static void acquire(const char* place) {
    __tsan_acquire(const_cast<char*>(place));
  }
  static void release(const char* place) {
    __tsan_release(const_cast<char*>(place));
  }
#else
  static void acquire(const char* /*place*/) {}
  static void release(const char* /*place*/) {}
#endif

  char start_ = 0, end_ = 0;
};

/// A loop of which each thread takes the next call until none is left or one has failed.
class SharedLoop {
 public:
  SharedLoop(std::size_t count, const std::function<void(std::size_t)>& task) : count_(count), task_(task) {}

  /// Takes part on a thread that may not ask the caller's question: ends with the others.
  void help() {
    order_.part_begins();
    {
      const std::lock_guard lock(mutex_);
      ++helping_;
    }
    {
      const InterruptionScope scope([&] { return has_failed_.load(); });
      take_calls();
    }
    {
      const std::lock_guard lock(mutex_);
      if (--helping_ == 0)
        none_helps_.notify_all();
    }
    order_.part_ends();
  }

  /// Takes part on the calling thread, which asks whether to end also while it waits for the others.
  void lead() {
    /// Time between two questions while the others work.
    constexpr std::chrono::milliseconds pause{10};
    take_calls();
    std::unique_lock lock(mutex_);
    while (!none_helps_.wait_for(lock, pause, [&] { return helping_ == 0; })) {
      if (has_failed_)
        continue;
      lock.unlock();
      guarded([] { check_interruption(); });
      lock.lock();
    }
  }

  /// Throws what one of the calls has thrown, if any.
  void rethrow() const {
    order_.loop_ended();
    if (failure_)
      std::rethrow_exception(failure_);
  }

 private:
  void take_calls() {
    guarded([&] {
      for (std::size_t k = next_++; k < count_ && !has_failed_; k = next_++) {
        check_interruption();
        task_(k);
      }
    });
  }

  /// Keeps what an action throws first; then the others end.
  template <typename Action>
  void guarded(const Action& action) {
    try {
      action();
    } catch (...) {
      const std::lock_guard lock(mutex_);
      if (!failure_)
        failure_ = std::current_exception();
      has_failed_ = true;
    }
  }

  std::size_t count_;
  const std::function<void(std::size_t)>& task_;
  std::atomic<std::size_t> next_ = 0;
  std::atomic<bool> has_failed_ = false;
  std::mutex mutex_;
  std::condition_variable none_helps_;
  std::size_t helping_ = 0;  ///< number of threads beside the calling one
  std::exception_ptr failure_;
  LoopOrder order_;  ///< last: all of the above is there when the loop begins
};

/// Arenas that no loop uses now. Each loop has an arena of its own, so that a thread that waits for its loop
/// takes no calls of another one. They are used again: the library of threads looks for work through a list
/// of all arenas, to which each new arena adds one while other threads work.
class IdleArenas {
 public:
  std::unique_ptr<tbb::task_arena> borrow() {
    const std::lock_guard lock(mutex_);
    if (arenas_.empty())
      return std::make_unique<tbb::task_arena>();
    std::unique_ptr<tbb::task_arena> arena = std::move(arenas_.back());
    arenas_.pop_back();
    return arena;
  }

  void give_back(std::unique_ptr<tbb::task_arena> arena) {
    const std::lock_guard lock(mutex_);
    arenas_.push_back(std::move(arena));
  }

 private:
  std::mutex mutex_;
  std::vector<std::unique_ptr<tbb::task_arena>> arenas_;
};

/// Never destroyed: a thread may end its loop after the program has begun to end.
IdleArenas& idle_arenas() {
  static auto& arenas = *new IdleArenas;
  return arenas;
}

}  // namespace

void parallel_for(std::size_t count, std::size_t threads, const std::function<void(std::size_t)>& task) {
  const std::size_t together = count <= 1 ? 1 : std::min(threads_of(threads), count);
  if (together == 1) {
    for (std::size_t k = 0; k < count; ++k) {
      check_interruption();
      task(k);
    }
    return;
  }
  SharedLoop loop(count, task);
  std::unique_ptr<tbb::task_arena> arena = idle_arenas().borrow();
  arena->execute([&] {
    tbb::task_group helpers;
    for (std::size_t k = 1; k < together; ++k)
      helpers.run([&] { loop.help(); });
    loop.lead();
    // Those that have not begun find nothing left.
    helpers.wait();
  });
  idle_arenas().give_back(std::move(arena));
  loop.rethrow();
}

}  // namespace fringe::detail
