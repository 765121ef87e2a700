#include "simd/lanes_avx2.hpp"

#include "simd/all_kernels.hpp"

namespace fringe::detail {

template <>
struct Registers<InstructionSet::avx2> {
  using Doubles = LanesAvx2;
  using Floats = FloatLanesAvx2;
};

template const BatchKernels& compiled_kernels<BatchKernels, InstructionSet::avx2>();
template const DerivativeKernels& compiled_kernels<DerivativeKernels, InstructionSet::avx2>();
template const TreeKernels& compiled_kernels<TreeKernels, InstructionSet::avx2>();
template const GjkFilter& compiled_kernels<GjkFilter, InstructionSet::avx2>();
template const ChargeKernels& compiled_kernels<ChargeKernels, InstructionSet::avx2>();
template const NodeKernels& compiled_kernels<NodeKernels, InstructionSet::avx2>();
template const ProductKernels<float>& compiled_kernels<ProductKernels<float>, InstructionSet::avx2>();
template const ProductKernels<double>& compiled_kernels<ProductKernels<double>, InstructionSet::avx2>();

}  // namespace fringe::detail
