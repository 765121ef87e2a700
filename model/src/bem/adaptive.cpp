#include "bem/adaptive.hpp"

#include <algorithm>
#include <cmath>
#include <queue>
#include <tuple>

namespace fringe::detail {
namespace {

/// Fraction of its missing energy that a group keeps after its triangles are halved; less where the charge is
/// smooth.
constexpr double left = 0.4;

/// Triangles in groups of several are quartered first, which is as much as two halvings.
double left_after(const PanelGroup& group, int step) {
  return group.is_quartered || step > 0 ? left : left * left;
}

/// Returns the number of panels that a further step adds to a group.
std::size_t added_by(const PanelGroup& group, int step) {
  if (group.is_quartered)
    return group.count << step;
  return step == 0 ? 3 * group.count : 4 * group.count << (step - 1);
}

/// A step of a group's refinement, with the energy that each of its triangles misses before it.
struct Step {
  double energy;
  std::size_t group;
  int step;
  double energy_of_all;

  bool operator<(const Step& other) const {
    return std::tuple(energy, other.group) < std::tuple(other.energy, group);
  }
};

/// Returns the number of steps in which to refine each group of panels, as PanelMesh::refine takes them;
/// empty if nothing is to be refined. Marks the groups with the largest error indicators (Dörfler marking):
/// as many as it takes to bring the missing energy down to what is allowed, and no more than add as many
/// panels as may be added. So that few refinements suffice, marks more until these add four tenths of the
/// panels, but none of negligible indicator. Marks groups with equal indicators together. With one step for
/// each group, it also stops when the marked ones have the greater part of the energy; with more, a group is
/// marked again if what each of its triangles is expected to miss then is still among the largest.
std::vector<int> mark_for_refinement(const std::vector<PanelGroup>& groups, const Assessment& found) {
  /// Fraction of the missing energy at which marking may stop where groups are marked once: the rest is too
  /// little to be surely worth refining.
  constexpr double greater_part = 0.75;
  /// Ratio of indicators above which two are equal up to what quadratures and iterations leave.
  constexpr double alike = 0.95;
  /// Part of the panels that a refinement adds at least, so that few refinements suffice, and part of the
  /// largest indicator below which a group is not worth it.
  constexpr double least_growth = 0.4, worthless = 1e-3;
  std::priority_queue<Step> steps;
  std::size_t panels = 0;
  for (std::size_t k = 0; k < groups.size(); ++k) {
    const double energy = found.indicators[index_of(k)];
    steps.push({energy, k, 0, energy});
    panels += groups[k].count;
  }
  const double total = found.indicators.sum(), largest = groups.empty() ? 0 : found.indicators.maxCoeff();
  double taken = 0, gained = 0, last = 0;
  std::size_t added = 0;
  std::vector<int> times(groups.size(), 0);
  while (!steps.empty()) {
    const auto [energy, k, step, energy_of_all] = steps.top();
    steps.pop();
    const PanelGroup& group = groups[k];
    const bool enough =
        total - gained <= found.allowed || (found.most_steps == 1 && taken >= greater_part * total);
    const bool is_small = energy < worthless * largest ||
                          static_cast<double>(added) >= least_growth * static_cast<double>(panels);
    if ((enough && is_small && energy < alike * last) || added + added_by(group, step) > found.most_added)
      break;
    times[k] = step + 1;
    last = energy;
    added += added_by(group, step);
    const double rest = left_after(group, step);
    taken += energy;
    gained += (step == 0 ? 1 - left : 1 - rest) * energy_of_all;
    if (step + 1 < found.most_steps) {
      const double parts = group.is_quartered || step > 0 ? 2 : 4;
      steps.push({rest / parts * energy, k, step + 1, rest * energy_of_all});
    }
  }
  return added > 0 ? times : std::vector<int>{};
}

}  // namespace

void PanelGrowth::measure(double excess, std::size_t unknowns) {
  /// Powers between which it falls: 1.8 to 4 were measured for a patient under an X-ray arm. A larger power
  /// is not believed: where the first solution misses a feature, the error falls by far more once, and not
  /// again (nine robot arms).
  constexpr double least = 1.7, most = 5;
  is_first_ = unknowns_ == 0;
  if (!is_first_) {
    const double growth = static_cast<double>(unknowns) / static_cast<double>(unknowns_);
    power_ = growth > 1 ? std::clamp(std::log(excess_ / excess) / std::log(growth), least, most) : least;
  }
  excess_ = excess;
  unknowns_ = unknowns;
}

std::size_t PanelGrowth::most_added(std::size_t panels) const {
  /// Part of the first estimated errors that is stated, as a rule, once it is known how much of them a
  /// refinement uses up: with this caution 0.25 to 0.54 on eight of nine robot arms.
  constexpr double expected_use = 0.4;
  constexpr double least_growth = 0.1, first_growth = 0.25, later_growth = 0.6;
  /// Number of panels that a refinement may always add.
  constexpr std::size_t few_panels = 1000;
  const double most_growth = is_first_ ? first_growth : later_growth;
  const double excess = excess_margin * excess_ * (is_first_ ? expected_use : 1);
  const double growth = std::clamp(std::pow(excess, 1 / power_) - 1, least_growth, most_growth);
  return std::max(static_cast<std::size_t>(growth * static_cast<double>(panels)), few_panels);
}

void solve_adaptively(AdaptiveProblem& problem) {
  while (true) {
    const Assessment found = problem.solve();
    if (found.is_last || !problem.refine(mark_for_refinement(problem.groups(), found)))
      return;
  }
}

}  // namespace fringe::detail
