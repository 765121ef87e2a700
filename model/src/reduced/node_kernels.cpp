#include "reduced/node_kernels.hpp"

#include <vector>

namespace fringe::detail {
namespace {

std::vector<const NodeKernels*> runnable_node_kernels() {
  std::vector<const NodeKernels*> runnable{&node_kernels_scalar};
#ifdef FRINGE_X86_KERNELS
  runnable.push_back(&node_kernels_sse2);
  __builtin_cpu_init();
  if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma"))
    runnable.push_back(&node_kernels_avx2);
  if (__builtin_cpu_supports("avx512f"))
    runnable.push_back(&node_kernels_avx512);
#endif
  return runnable;
}

}  // namespace

std::span<const NodeKernels* const> available_node_kernels() {
  static const std::vector<const NodeKernels*> available = runnable_node_kernels();
  return available;
}

const NodeKernels& best_node_kernels() {
  static const NodeKernels& best = *available_node_kernels().back();
  return best;
}

}  // namespace fringe::detail
