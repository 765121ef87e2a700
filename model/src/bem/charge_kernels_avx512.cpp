// GCC 12 takes the deliberately undefined registers of its own AVX-512 header for mistakes.
#ifndef __clang__
#pragma GCC diagnostic ignored "-Wuninitialized"
#pragma GCC diagnostic ignored "-Wmaybe-uninitialized"
#endif
#include "bem/charge_kernels.hpp"
#include "bem/charge_kernels_template.hpp"
#include "simd/lanes_avx512.hpp"

namespace fringe::detail {

const ChargeKernels charge_kernels_avx512{"AVX-512", &ChargeKernelsFor<LanesAvx512>::face_potentials,
                                          &ChargeKernelsFor<LanesAvx512>::triangle_potentials,
                                          &ChargeKernelsFor<LanesAvx512>::add_combinations};

}  // namespace fringe::detail
