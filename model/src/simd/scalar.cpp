#include "simd/lanes_scalar.hpp"

#include "simd/all_kernels.hpp"

namespace fringe::detail {

template <>
struct Registers<InstructionSet::scalar> {
  using Doubles = LanesScalar;
  using Floats = FloatLanesScalar;
};

template const BatchKernels& compiled_kernels<BatchKernels, InstructionSet::scalar>();
template const DerivativeKernels& compiled_kernels<DerivativeKernels, InstructionSet::scalar>();
template const TreeKernels& compiled_kernels<TreeKernels, InstructionSet::scalar>();
template const GjkFilter& compiled_kernels<GjkFilter, InstructionSet::scalar>();
template const ChargeKernels& compiled_kernels<ChargeKernels, InstructionSet::scalar>();
template const NodeKernels& compiled_kernels<NodeKernels, InstructionSet::scalar>();
template const ProductKernels<float>& compiled_kernels<ProductKernels<float>, InstructionSet::scalar>();
template const ProductKernels<double>& compiled_kernels<ProductKernels<double>, InstructionSet::scalar>();

}  // namespace fringe::detail
