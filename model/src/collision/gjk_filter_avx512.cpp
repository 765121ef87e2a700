// GCC takes the undefined register in its own headers' intrinsics for an error of ours.
#ifndef __clang__
#pragma GCC diagnostic ignored "-Wuninitialized"
#pragma GCC diagnostic ignored "-Wmaybe-uninitialized"
#endif
#include "collision/gjk_filter_template.hpp"
#include "simd/lanes_avx512.hpp"

namespace fringe::detail {

const QuickSearch search_avx512{"AVX-512", &QuickSearchFor<LanesAvx512>::decide,
                                &QuickSearchFor<LanesAvx512>::prove, &QuickSearchFor<LanesAvx512>::support,
                                &QuickSearchFor<LanesAvx512>::box_gap};

}  // namespace fringe::detail
