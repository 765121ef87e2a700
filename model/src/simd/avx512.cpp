// GCC 12 warns about the deliberately undefined registers of its own AVX-512 header.
#ifndef __clang__
#pragma GCC diagnostic ignored "-Wuninitialized"
#pragma GCC diagnostic ignored "-Wmaybe-uninitialized"
#endif

#include "simd/lanes_avx512.hpp"

#include "simd/all_kernels.hpp"

namespace fringe::detail {

template <>
struct Registers<InstructionSet::avx512> {
  using Doubles = LanesAvx512;
  using Floats = FloatLanesAvx512;
};

template const BatchKernels& compiled_kernels<BatchKernels, InstructionSet::avx512>();
template const DerivativeKernels& compiled_kernels<DerivativeKernels, InstructionSet::avx512>();
template const TreeKernels& compiled_kernels<TreeKernels, InstructionSet::avx512>();
template const GjkFilter& compiled_kernels<GjkFilter, InstructionSet::avx512>();
template const ChargeKernels& compiled_kernels<ChargeKernels, InstructionSet::avx512>();
template const NodeKernels& compiled_kernels<NodeKernels, InstructionSet::avx512>();
template const ProductKernels<float>& compiled_kernels<ProductKernels<float>, InstructionSet::avx512>();
template const ProductKernels<double>& compiled_kernels<ProductKernels<double>, InstructionSet::avx512>();

}  // namespace fringe::detail
