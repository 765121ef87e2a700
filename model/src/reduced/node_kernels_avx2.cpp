#include "reduced/node_kernels.hpp"
#include "reduced/node_kernels_template.hpp"
#include "simd/single_lanes_avx2.hpp"

namespace fringe::detail {

const NodeKernels node_kernels_avx2{"AVX2",
                                    &NodeKernelsFor<SingleLanesAvx2>::ellipses,
                                    &NodeKernelsFor<SingleLanesAvx2>::lay,
                                    &NodeKernelsFor<SingleLanesAvx2>::fill,
                                    &NodeKernelsFor<SingleLanesAvx2>::apply,
                                    &NodeKernelsFor<SingleLanesAvx2>::spread,
                                    &NodeKernelsFor<SingleLanesAvx2>::gather,
                                    &NodeKernelsFor<SingleLanesAvx2>::multiply,
                                    &NodeKernelsFor<SingleLanesAvx2>::dot,
                                    &NodeKernelsFor<SingleLanesAvx2>::add};

}  // namespace fringe::detail
