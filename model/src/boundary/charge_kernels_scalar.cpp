#include "../batch/lanes_scalar.hpp"
#include "charge_kernels.hpp"
#include "charge_kernels_template.hpp"

namespace fringe::detail {

const ChargeKernels charge_kernels_scalar{"scalar", &ChargeKernelsFor<LanesScalar>::face_potentials,
                                          &ChargeKernelsFor<LanesScalar>::triangle_potentials,
                                          &ChargeKernelsFor<LanesScalar>::add_combinations};

}  // namespace fringe::detail
