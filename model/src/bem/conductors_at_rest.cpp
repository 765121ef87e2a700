#include "bem/conductors_at_rest.hpp"

#include <algorithm>
#include <functional>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "bem/group_densities.hpp"
#include "numeric/progress.hpp"
#include "readings/maxwell_matrix.hpp"
#include "surface/simplification.hpp"

namespace fringe::detail {
namespace {

using Eigen::AlignedBox3d;
using Eigen::Index;
using Eigen::VectorXd;

/// Fraction of rtol to which the conjugate gradients find the charges. Their energy is found to the square of
/// that, but the potentials far away not: those of a sensor and of the guard around it nearly cancel there.
constexpr double iteration_part = 1e-2;

/// Ratio of the tolerance of simplified surfaces to rtol.
constexpr double simplification_at_rest = 1;

/// Returns the bodies with triangles on all of them, few enough for the panels that are allowed.
ChargedBodies in_triangles(ChargedBodies bodies, double rtol, std::size_t most_panels) {
  for (ChargedBody& body : bodies.bodies)
    body.surface = triangulated(body.surface);
  // Energies have to be accurate; readings and the small entries between conductors need not.
  bodies.readings.clear();
  bodies.are_entries_asked = false;
  return Simplification(std::move(bodies), simplification_at_rest * rtol, most_panels / 2).bodies();
}

/// Returns the largest stated error of the energies that are asked for, relative to these.
double largest_error(const PanelSolution& solution, const ChargedBodies& bodies) {
  const VectorXd own = asked_energies(solution.all.fine, bodies);
  const VectorXd missing = (solution.all.fine - solution.all.coarse).diagonal().cwiseAbs();
  return error_per_panel_change * missing.cwiseQuotient(own).maxCoeff();
}

/// Marks the groups of panels that are at least half as important as the most important one, or all of them
/// if importance is not known.
std::vector<int> most_important(const PanelMesh& mesh,
                                const std::function<double(const AlignedBox3d&)>& importance) {
  std::vector<int> times(mesh.groups().size(), 1);
  if (!importance)
    return times;
  std::vector<double> values;
  values.reserve(times.size());
  for (const PanelGroup& group : mesh.groups()) {
    AlignedBox3d box;
    for (std::size_t k = group.first; k < group.first + group.count; ++k)
      for (const Eigen::Vector3d& corner : mesh.panels()[k].corners)
        box.extend(corner);
    values.push_back(importance(box));
  }
  const double limit = *std::max_element(values.begin(), values.end()) / 2;
  for (std::size_t k = 0; k < values.size(); ++k)
    times[k] = values[k] >= limit ? 1 : 0;
  return times;
}

}  // namespace

ConductorsAtRest::ConductorsAtRest(ChargedBodies bodies, double rtol, std::size_t most_panels,
                                   std::size_t least_panels, std::size_t threads,
                                   const std::function<double(const AlignedBox3d&)>& importance)
    : bodies_(in_triangles(std::move(bodies), rtol, most_panels)),
      system_(bodies_, {grading_part * rtol, most_panels / most_graded_part}, threads), rtol_(rtol),
      tolerance_(rtol / first_tolerance_part), most_panels_(most_panels) {
  const std::size_t enough = least_panels + (importance ? mesh().panels().size() : 0);
  while (mesh().panels().size() < enough)
    // Without charges, triangles are halved across their longest sides.
    system_.refine_groups(most_important(mesh(), importance),
                          Eigen::MatrixXd(index_of(mesh().panels().size()), 0));
  solve_adaptively(*this);
}

Assessment ConductorsAtRest::solve() {
  solution_ = system_.solve_definite({}, tolerance_, iteration_part * rtol_ * iteration_part * rtol_);
  error_ = largest_error(solution_, bodies_);
  const std::size_t panels = mesh().panels().size();
  show_progress(fmt::format("{} panels, error {:.2g} of {:g} asked for", panels, error_, rtol_));
  return {error_ <= rtol_, solution_.error_indicators,
          solution_.error_indicators.sum() * rtol_ / (excess_margin * error_),
          std::min(panels, most_panels_ - std::min(panels, most_panels_))};
}

bool ConductorsAtRest::refine(const std::vector<int>& steps) {
  if (steps.empty())
    return false;
  system_.refine_groups(steps, solution_.charges);
  return true;
}

}  // namespace fringe::detail
