#include "collision/gjk_filter.hpp"

#include <vector>

namespace fringe::detail {
namespace {

std::vector<const QuickSearch*> runnable_searches() {
  std::vector<const QuickSearch*> runnable{&search_scalar};
#ifdef FRINGE_X86_KERNELS
  runnable.push_back(&search_sse2);
  __builtin_cpu_init();
  if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma"))
    runnable.push_back(&search_avx2);
  if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512cd") &&
      __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512bw"))
    runnable.push_back(&search_avx512);
#endif
  return runnable;
}

}  // namespace

std::span<const QuickSearch* const> available_searches() {
  static const std::vector<const QuickSearch*> available = runnable_searches();
  return available;
}

const QuickSearch& best_search() {
  static const QuickSearch& best = *available_searches().back();
  return best;
}

}  // namespace fringe::detail
