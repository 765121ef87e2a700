#include "reduced/node_kernels.hpp"
#include "reduced/node_kernels_template.hpp"
#include "simd/single_lanes_sse2.hpp"

namespace fringe::detail {

const NodeKernels node_kernels_sse2{"SSE2",
                                    &NodeKernelsFor<SingleLanesSse2>::ellipses,
                                    &NodeKernelsFor<SingleLanesSse2>::lay,
                                    &NodeKernelsFor<SingleLanesSse2>::fill,
                                    &NodeKernelsFor<SingleLanesSse2>::apply,
                                    &NodeKernelsFor<SingleLanesSse2>::spread,
                                    &NodeKernelsFor<SingleLanesSse2>::gather,
                                    &NodeKernelsFor<SingleLanesSse2>::multiply,
                                    &NodeKernelsFor<SingleLanesSse2>::dot,
                                    &NodeKernelsFor<SingleLanesSse2>::add};

}  // namespace fringe::detail
