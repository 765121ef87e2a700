#include "integral/batch/kernel_sets.hpp"
#include "integral/batch/kernels_template.hpp"
#include "simd/lanes_avx2.hpp"

namespace fringe::detail {

const Kernels kernels_avx2{"AVX2",
                           &KernelsFor<LanesAvx2>::measure,
                           &KernelsFor<LanesAvx2>::integrate,
                           &KernelsFor<LanesAvx2>::integrate_virtual,
                           &KernelsFor<LanesAvx2>::sum_over_nodes,
                           &KernelsFor<LanesAvx2>::soft_inverse_distances};

}  // namespace fringe::detail
