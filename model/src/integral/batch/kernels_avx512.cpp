// GCC 12 takes the deliberately undefined registers of its own AVX-512 header for mistakes.
#ifndef __clang__
#pragma GCC diagnostic ignored "-Wuninitialized"
#pragma GCC diagnostic ignored "-Wmaybe-uninitialized"
#endif

#include "integral/batch/kernel_sets.hpp"
#include "integral/batch/kernels_template.hpp"
#include "simd/lanes_avx512.hpp"

namespace fringe::detail {

const Kernels kernels_avx512{"AVX-512",
                             &KernelsFor<LanesAvx512>::measure,
                             &KernelsFor<LanesAvx512>::integrate,
                             &KernelsFor<LanesAvx512>::integrate_virtual,
                             &KernelsFor<LanesAvx512>::sum_over_nodes,
                             &KernelsFor<LanesAvx512>::soft_inverse_distances};

}  // namespace fringe::detail
