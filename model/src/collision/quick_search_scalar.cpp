#include "../batch/lanes_scalar.hpp"
#include "quick_search_template.hpp"

namespace fringe::detail {

const QuickSearch search_scalar{"scalar", &QuickSearchFor<LanesScalar>::decide,
                                &QuickSearchFor<LanesScalar>::prove, &QuickSearchFor<LanesScalar>::support,
                                &QuickSearchFor<LanesScalar>::box_gap};

}  // namespace fringe::detail
