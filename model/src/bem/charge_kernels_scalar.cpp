#include "bem/charge_kernels.hpp"
#include "bem/charge_kernels_template.hpp"
#include "simd/lanes_scalar.hpp"

namespace fringe::detail {

const ChargeKernels charge_kernels_scalar{"scalar", &ChargeKernelsFor<LanesScalar>::face_potentials,
                                          &ChargeKernelsFor<LanesScalar>::triangle_potentials,
                                          &ChargeKernelsFor<LanesScalar>::add_combinations};

}  // namespace fringe::detail
