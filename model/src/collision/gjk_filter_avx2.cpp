#include "collision/gjk_filter_template.hpp"
#include "simd/lanes_avx2.hpp"

namespace fringe::detail {

const QuickSearch search_avx2{"AVX2", &QuickSearchFor<LanesAvx2>::decide, &QuickSearchFor<LanesAvx2>::prove,
                              &QuickSearchFor<LanesAvx2>::support, &QuickSearchFor<LanesAvx2>::box_gap};

}  // namespace fringe::detail
