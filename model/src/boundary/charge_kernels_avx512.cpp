// GCC 12 takes the deliberately undefined registers of its own AVX-512 header for mistakes.
#ifndef __clang__
#pragma GCC diagnostic ignored "-Wuninitialized"
#pragma GCC diagnostic ignored "-Wmaybe-uninitialized"
#endif
#include "../batch/lanes_avx512.hpp"
#include "charge_kernels.hpp"
#include "charge_kernels_template.hpp"

namespace fringe::detail {

const ChargeKernels charge_kernels_avx512{"AVX-512", &ChargeKernelsFor<LanesAvx512>::face_potentials,
                                          &ChargeKernelsFor<LanesAvx512>::triangle_potentials,
                                          &ChargeKernelsFor<LanesAvx512>::add_combinations};

}  // namespace fringe::detail
