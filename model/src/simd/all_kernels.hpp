#pragma once

#include <type_traits>

#include "bem/charge_kernels_template.hpp"
#include "collision/gjk_filter_template.hpp"
#include "integral/batch/kernels_template.hpp"
#include "integral/derivative/kernels_template.hpp"
#include "integral/tree/kernels_template.hpp"
#include "numeric/product_kernels_template.hpp"
#include "reduced/node_kernels_template.hpp"
#include "simd/dispatch.hpp"

/// Collects the kernels of all kinds, as templates over the register, for the four files named after
/// instruction sets.
namespace fringe::detail {

/// The register types of an instruction set: `Doubles` and `Floats`. Each of the four files specialises this
/// template.
template <InstructionSet set>
struct Registers;

template <class Kernels, InstructionSet set>
const Kernels& compiled_kernels() {
  using Doubles = typename Registers<set>::Doubles;
  if constexpr (std::is_same_v<Kernels, BatchKernels>)
    return BatchKernelsFor<Doubles>::kernels;
  else if constexpr (std::is_same_v<Kernels, DerivativeKernels>)
    return DerivativeKernelsFor<Doubles>::kernels;
  else if constexpr (std::is_same_v<Kernels, TreeKernels>)
    return TreeKernelsFor<Doubles>::kernels;
  else if constexpr (std::is_same_v<Kernels, GjkFilter>)
    return GjkFilterFor<Doubles>::kernels;
  else if constexpr (std::is_same_v<Kernels, ChargeKernels>)
    return ChargeKernelsFor<Doubles>::kernels;
  else if constexpr (std::is_same_v<Kernels, ProductKernels<float>>)
    return ProductKernelsFor<float, Doubles>::kernels;
  else if constexpr (std::is_same_v<Kernels, ProductKernels<double>>)
    return ProductKernelsFor<double, Doubles>::kernels;
  else
    return NodeKernelsFor<typename Registers<set>::Floats>::kernels;
}

}  // namespace fringe::detail
