#include "bem/charge_kernels.hpp"
#include "bem/charge_kernels_template.hpp"
#include "simd/lanes_sse2.hpp"

namespace fringe::detail {

const ChargeKernels charge_kernels_sse2{"SSE2", &ChargeKernelsFor<LanesSse2>::face_potentials,
                                        &ChargeKernelsFor<LanesSse2>::triangle_potentials,
                                        &ChargeKernelsFor<LanesSse2>::add_combinations};

}  // namespace fringe::detail
