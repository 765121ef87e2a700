#include "reduced/node_kernels.hpp"
#include "reduced/node_kernels_template.hpp"
#include "simd/single_lanes_scalar.hpp"

namespace fringe::detail {

const NodeKernels node_kernels_scalar{"scalar",
                                      &NodeKernelsFor<SingleLanesScalar>::ellipses,
                                      &NodeKernelsFor<SingleLanesScalar>::lay,
                                      &NodeKernelsFor<SingleLanesScalar>::fill,
                                      &NodeKernelsFor<SingleLanesScalar>::apply,
                                      &NodeKernelsFor<SingleLanesScalar>::spread,
                                      &NodeKernelsFor<SingleLanesScalar>::gather,
                                      &NodeKernelsFor<SingleLanesScalar>::multiply,
                                      &NodeKernelsFor<SingleLanesScalar>::dot,
                                      &NodeKernelsFor<SingleLanesScalar>::add};

}  // namespace fringe::detail
