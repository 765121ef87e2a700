#include "integral/batch/kernel_sets.hpp"
#include "integral/batch/kernels_template.hpp"
#include "simd/lanes_sse2.hpp"

namespace fringe::detail {

const Kernels kernels_sse2{"SSE2",
                           &KernelsFor<LanesSse2>::measure,
                           &KernelsFor<LanesSse2>::integrate,
                           &KernelsFor<LanesSse2>::integrate_virtual,
                           &KernelsFor<LanesSse2>::sum_over_nodes,
                           &KernelsFor<LanesSse2>::soft_inverse_distances};

}  // namespace fringe::detail
