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

/// Tells clang's thread sanitizer the order that oneTBB gives to a parallel loop and that the tool cannot
/// see, because the library is compiled without it: what is done before the loop comes before every part of
/// its body, and that before what is done after the loop. Nothing is said about two parts of the body.
class LoopOrder {
 public:
  LoopOrder() { release(&start_); }

  /// The first statement of a part of the body.
  void part_begins() const { acquire(&start_); }
  /// The last one.
  void part_ends() const { release(&end_); }
  /// When the loop has returned.
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
