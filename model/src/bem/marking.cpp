#include "bem/marking.hpp"

#include <algorithm>
#include <numeric>

namespace fringe::detail {

std::vector<bool> groups_to_refine(const std::vector<PanelGroup>& groups, const Eigen::VectorXd& energies,
                                   double allowed, std::size_t most) {
  /// Fraction of its missing energy that a group keeps after refinement; less where the charge is smooth.
  constexpr double left = 0.4;
  /// Fraction of the missing energy at which marking may stop: the rest is too little to be surely worth
  /// refining.
  constexpr double greater_part = 0.75;
  /// Ratio of indicators above which two are equal up to the quadratures' errors.
  constexpr double alike = 0.99;
  std::vector<std::size_t> order(groups.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  const auto energy = [&](std::size_t group) { return energies[static_cast<Eigen::Index>(group)]; };
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return energy(a) > energy(b); });
  const double total = energies.sum();
  double taken = 0, last = 0;
  std::size_t added = 0;
  std::vector<bool> marked(groups.size(), false);
  for (const std::size_t group : order) {
    const bool enough = total - (1 - left) * taken <= allowed || taken >= greater_part * total;
    if ((enough && energy(group) < alike * last) || added + PanelMesh::growth(groups[group]) > most)
      break;
    marked[group] = true;
    last = energy(group);
    added += PanelMesh::growth(groups[group]);
    taken += last;
  }
  return added > 0 ? marked : std::vector<bool>{};
}

}  // namespace fringe::detail
