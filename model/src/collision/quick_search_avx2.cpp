#include "../batch/lanes_avx2.hpp"
#include "quick_search_template.hpp"

namespace fringe::detail {

const QuickSearch search_avx2{"AVX2", &QuickSearchFor<LanesAvx2>::decide, &QuickSearchFor<LanesAvx2>::prove,
                              &QuickSearchFor<LanesAvx2>::support, &QuickSearchFor<LanesAvx2>::box_gap};

}  // namespace fringe::detail
