// GCC 12 takes the deliberately undefined registers of its own AVX-512 header for mistakes.
#ifndef __clang__
#pragma GCC diagnostic ignored "-Wuninitialized"
#pragma GCC diagnostic ignored "-Wmaybe-uninitialized"
#endif

#include "reduced/node_kernels.hpp"
#include "reduced/node_kernels_template.hpp"
#include "simd/single_lanes_avx512.hpp"

namespace fringe::detail {

const NodeKernels node_kernels_avx512{"AVX-512",
                                      &NodeKernelsFor<SingleLanesAvx512>::ellipses,
                                      &NodeKernelsFor<SingleLanesAvx512>::lay,
                                      &NodeKernelsFor<SingleLanesAvx512>::fill,
                                      &NodeKernelsFor<SingleLanesAvx512>::apply,
                                      &NodeKernelsFor<SingleLanesAvx512>::spread,
                                      &NodeKernelsFor<SingleLanesAvx512>::gather,
                                      &NodeKernelsFor<SingleLanesAvx512>::multiply,
                                      &NodeKernelsFor<SingleLanesAvx512>::dot,
                                      &NodeKernelsFor<SingleLanesAvx512>::add};

}  // namespace fringe::detail
