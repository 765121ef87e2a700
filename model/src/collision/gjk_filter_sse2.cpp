#include "collision/gjk_filter_template.hpp"
#include "simd/lanes_sse2.hpp"

namespace fringe::detail {

const QuickSearch search_sse2{"SSE2", &QuickSearchFor<LanesSse2>::decide, &QuickSearchFor<LanesSse2>::prove,
                              &QuickSearchFor<LanesSse2>::support, &QuickSearchFor<LanesSse2>::box_gap};

}  // namespace fringe::detail
