#include "integral/batch/kernels.hpp"

#include <vector>

#include "integral/batch/kernel_sets.hpp"

namespace fringe::detail {
namespace {

std::vector<const Kernels*> runnable_kernels() {
  std::vector<const Kernels*> runnable{&kernels_scalar};
#ifdef FRINGE_X86_KERNELS
  runnable.push_back(&kernels_sse2);
  __builtin_cpu_init();
  if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma"))
    runnable.push_back(&kernels_avx2);
  if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512cd") &&
      __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512bw"))
    runnable.push_back(&kernels_avx512);
#endif
  return runnable;
}

}  // namespace

std::span<const Kernels* const> available_kernels() {
  static const std::vector<const Kernels*> available = runnable_kernels();
  return available;
}

const Kernels& best_kernels() {
  return *available_kernels().back();
}

}  // namespace fringe::detail
