#pragma once

#include <span>
#include <string_view>

/// Choice of kernels by the instruction sets that the processor can run (model/NUMERICS.md, section 12).
///
/// A kind of kernels is a structure of function pointers, declared in the folder that calls them:
/// BatchKernels, DerivativeKernels, TreeKernels, GjkFilter, ChargeKernels, NodeKernels and ProductKernels.
/// One template over the vector register defines each kind; simd/scalar.cpp, sse2.cpp, avx2.cpp and
/// avx512.cpp compile all of them for one instruction set each.
///
/// Headers that these files include keep to plain numbers, pointers and templates over the register: another
/// inline function could be emitted there with instructions that the machine does not have, and the linker
/// could keep that copy for the whole program.
namespace fringe::detail {

/// The instruction sets that kernels are compiled for, the slowest first: plain C++ for any processor, and
/// those of x86-64.
enum class InstructionSet { scalar, sse2, avx2, avx512 };

/// Returns "scalar", "SSE2", "AVX2" or "AVX-512".
std::string_view name_of(InstructionSet set);

/// Asks the processor, once, which instruction sets it can run. The slowest comes first.
std::span<const InstructionSet> available_instruction_sets();

/// Returns one kind of kernels as compiled for one instruction set. Defined in simd/all_kernels.hpp,
/// instantiated in the file of the instruction set.
template <class Kernels, InstructionSet set>
const Kernels& compiled_kernels();

/// Returns one kind of kernels for an instruction set that is available.
template <class Kernels>
const Kernels& kernels([[maybe_unused]] InstructionSet set) {
#ifdef __x86_64__
  if (set == InstructionSet::avx512)
    return compiled_kernels<Kernels, InstructionSet::avx512>();
  if (set == InstructionSet::avx2)
    return compiled_kernels<Kernels, InstructionSet::avx2>();
  if (set == InstructionSet::sse2)
    return compiled_kernels<Kernels, InstructionSet::sse2>();
#endif
  return compiled_kernels<Kernels, InstructionSet::scalar>();
}

/// Returns one kind of kernels for the fastest instruction set of this machine.
template <class Kernels>
const Kernels& best_kernels() {
  static const auto& best = kernels<Kernels>(available_instruction_sets().back());
  return best;
}

}  // namespace fringe::detail
