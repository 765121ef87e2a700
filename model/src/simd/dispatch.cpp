#include "simd/dispatch.hpp"

#include <vector>

namespace fringe::detail {
namespace {

std::vector<InstructionSet> runnable_instruction_sets() {
  std::vector<InstructionSet> runnable{InstructionSet::scalar};
#ifdef __x86_64__
  runnable.push_back(InstructionSet::sse2);
  __builtin_cpu_init();
  if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma"))
    runnable.push_back(InstructionSet::avx2);
  if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512cd") &&
      __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512bw"))
    runnable.push_back(InstructionSet::avx512);
#endif
  return runnable;
}

}  // namespace

std::string_view name_of(InstructionSet set) {
  switch (set) {
  case InstructionSet::sse2:
    return "SSE2";
  case InstructionSet::avx2:
    return "AVX2";
  case InstructionSet::avx512:
    return "AVX-512";
  default:
    return "scalar";
  }
}

std::span<const InstructionSet> available_instruction_sets() {
  static const std::vector<InstructionSet> available = runnable_instruction_sets();
  return available;
}

}  // namespace fringe::detail
