#include "collision/gjk_filter_template.hpp"
#include "simd/lanes_scalar.hpp"

namespace fringe::detail {

const QuickSearch search_scalar{"scalar", &QuickSearchFor<LanesScalar>::decide,
                                &QuickSearchFor<LanesScalar>::prove, &QuickSearchFor<LanesScalar>::support,
                                &QuickSearchFor<LanesScalar>::box_gap};

}  // namespace fringe::detail
