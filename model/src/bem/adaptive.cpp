#include "bem/adaptive.hpp"

#include "bem/marking.hpp"

namespace fringe::detail {

void solve_adaptively(AdaptiveProblem& problem) {
  while (true) {
    const Assessment found = problem.solve();
    if (found.is_last ||
        !problem.refine(mark_for_refinement(problem.groups(), found.indicators, found.allowed,
                                            found.most_added, found.most_steps)))
      return;
  }
}

}  // namespace fringe::detail
