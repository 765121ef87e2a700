#include "../batch/lanes_sse2.hpp"
#include "quick_search_template.hpp"

namespace fringe::detail {

const QuickSearch search_sse2{"SSE2", &QuickSearchFor<LanesSse2>::decide, &QuickSearchFor<LanesSse2>::prove,
                              &QuickSearchFor<LanesSse2>::support, &QuickSearchFor<LanesSse2>::box_gap};

}  // namespace fringe::detail
