#include "integral/tree/direct_choices.hpp"

#include <vector>

namespace fringe::detail {
namespace {

/// Prepares the rules for one tolerance per decade. Preparing takes longer than integrating, so it is done
/// once; between two decades the number of points hardly changes.
std::vector<DirectChoices> make_ladder() {
  std::vector<DirectChoices> ladder;
  for (const double tolerance : {1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10, 1e-11, 1e-12})
    ladder.push_back({0.97 * tolerance, PreparedChoices(0.97 * tolerance)});
  ladder.push_back({0, PreparedChoices(0)});
  return ladder;
}

}  // namespace

const DirectChoices& direct_choices(double tolerance) {
  static const std::vector<DirectChoices> ladder = make_ladder();
  std::size_t step = 0;
  while (bound_of_sum(1 + ladder[step].relative_error, ladder[step].relative_error) > tolerance)
    ++step;
  return ladder[step];
}

}  // namespace fringe::detail
