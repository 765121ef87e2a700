#pragma once

#include "integral/batch/kernels.hpp"

/// The sets of functions that the library may hold, each compiled for its own instruction set.
namespace fringe::detail {

extern const Kernels kernels_scalar;
#ifdef FRINGE_X86_KERNELS
extern const Kernels kernels_sse2;
extern const Kernels kernels_avx2;
extern const Kernels kernels_avx512;
#endif

}  // namespace fringe::detail
