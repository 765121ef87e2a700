#include "bem/charge_kernels.hpp"

#include <vector>

namespace fringe::detail {
namespace {

std::vector<const ChargeKernels*> runnable_charge_kernels() {
  std::vector<const ChargeKernels*> runnable{&charge_kernels_scalar};
#ifdef FRINGE_X86_KERNELS
  runnable.push_back(&charge_kernels_sse2);
  __builtin_cpu_init();
  if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma"))
    runnable.push_back(&charge_kernels_avx2);
  if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512cd") &&
      __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512bw"))
    runnable.push_back(&charge_kernels_avx512);
#endif
  return runnable;
}

}  // namespace

std::span<const ChargeKernels* const> available_charge_kernels() {
  static const std::vector<const ChargeKernels*> available = runnable_charge_kernels();
  return available;
}

const ChargeKernels& best_charge_kernels() {
  static const ChargeKernels& best = *available_charge_kernels().back();
  return best;
}

}  // namespace fringe::detail
