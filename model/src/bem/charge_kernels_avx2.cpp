#include "bem/charge_kernels.hpp"
#include "bem/charge_kernels_template.hpp"
#include "simd/lanes_avx2.hpp"

namespace fringe::detail {

const ChargeKernels charge_kernels_avx2{"AVX2", &ChargeKernelsFor<LanesAvx2>::face_potentials,
                                        &ChargeKernelsFor<LanesAvx2>::triangle_potentials,
                                        &ChargeKernelsFor<LanesAvx2>::add_combinations};

}  // namespace fringe::detail
