#include "integral/batch/kernel_sets.hpp"
#include "integral/batch/kernels_template.hpp"
#include "simd/lanes_scalar.hpp"

namespace fringe::detail {

const Kernels kernels_scalar{"scalar",
                             &KernelsFor<LanesScalar>::measure,
                             &KernelsFor<LanesScalar>::integrate,
                             &KernelsFor<LanesScalar>::integrate_virtual,
                             &KernelsFor<LanesScalar>::sum_over_nodes,
                             &KernelsFor<LanesScalar>::soft_inverse_distances};

}  // namespace fringe::detail
