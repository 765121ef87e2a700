#include "simd/lanes_sse2.hpp"

#include "simd/all_kernels.hpp"

namespace fringe::detail {

template <>
struct Registers<InstructionSet::sse2> {
  using Doubles = LanesSse2;
  using Floats = FloatLanesSse2;
};

template const BatchKernels& compiled_kernels<BatchKernels, InstructionSet::sse2>();
template const DerivativeKernels& compiled_kernels<DerivativeKernels, InstructionSet::sse2>();
template const TreeKernels& compiled_kernels<TreeKernels, InstructionSet::sse2>();
template const GjkFilter& compiled_kernels<GjkFilter, InstructionSet::sse2>();
template const ChargeKernels& compiled_kernels<ChargeKernels, InstructionSet::sse2>();
template const NodeKernels& compiled_kernels<NodeKernels, InstructionSet::sse2>();
template const ProductKernels<float>& compiled_kernels<ProductKernels<float>, InstructionSet::sse2>();
template const ProductKernels<double>& compiled_kernels<ProductKernels<double>, InstructionSet::sse2>();

}  // namespace fringe::detail
