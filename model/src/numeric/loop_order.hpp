#pragma once

#if defined(__has_feature)
#if __has_feature(thread_sanitizer)
#define FRINGE_THREAD_SANITIZER
#endif
#endif
#ifdef FRINGE_THREAD_SANITIZER
#include <sanitizer/tsan_interface.h>
#endif

namespace fringe::detail {

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

}  // namespace fringe::detail
