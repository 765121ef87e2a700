#include "bem/conductors_at_rest.hpp"

#include <algorithm>
#include <functional>
#include <stdexcept>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "bem/error_indicators.hpp"
#include "bem/group_densities.hpp"
#include "bem/maxwell_matrix.hpp"
#include "bem/simplification.hpp"
#include "numeric/progress.hpp"

namespace fringe::detail {
namespace {

using Eigen::AlignedBox3d;
using Eigen::Index;
using Eigen::VectorXd;

/// Ratio of rtol to the quadratures' tolerance.
constexpr double quadrature_part = 50;

/// Finest relative tolerance of the quadratures. Below it, rounding errors dominate the matrix elements.
constexpr double finest_tolerance = 1e-13;

/// Fraction of rtol to which the conjugate gradients find the charges. Their energy is found to the square of
/// that, but the potentials far away not: those of a sensor and of the guard around it nearly cancel there.
constexpr double iteration_part = 1e-2;

/// Ratio of the tolerance of simplified surfaces to rtol.
constexpr double simplification_at_rest = 1;

/// Returns the bodies with triangles on all of them, few enough for the panels that are allowed.
ChargedBodies in_triangles(ChargedBodies bodies, double rtol, std::size_t most_panels) {
  for (ChargedBody& body : bodies.bodies)
    body.surface = triangulated(body.surface);
  bodies.readings.clear();
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
std::vector<bool> most_important(const PanelMesh& mesh,
                                 const std::function<double(const AlignedBox3d&)>& importance) {
  std::vector<bool> marked(mesh.groups().size(), true);
  if (!importance)
    return marked;
  std::vector<double> values;
  values.reserve(marked.size());
  for (const PanelGroup& group : mesh.groups()) {
    AlignedBox3d box;
    for (std::size_t k = group.first; k < group.first + group.count; ++k)
      for (const Eigen::Vector3d& corner : mesh.panels()[k].corners)
        box.extend(corner);
    values.push_back(importance(box));
  }
  const double limit = *std::max_element(values.begin(), values.end()) / 2;
  for (std::size_t k = 0; k < values.size(); ++k)
    marked[k] = values[k] >= limit;
  return marked;
}

}  // namespace

ConductorsAtRest::ConductorsAtRest(ChargedBodies bodies, double rtol, std::size_t most_panels,
                                   std::size_t least_panels, std::size_t threads,
                                   const std::function<double(const AlignedBox3d&)>& importance)
    : bodies_(in_triangles(std::move(bodies), rtol, most_panels)),
      system_(bodies_, {grading_part * rtol, most_panels / most_graded_part}, threads) {
  const std::size_t enough = least_panels + (importance ? mesh().panels().size() : 0);
  while (mesh().panels().size() < enough)
    // With equal charges, triangles are halved across their longest sides.
    system_.refine_groups(most_important(mesh(), importance),
                          Eigen::MatrixXd::Ones(index_of(mesh().panels().size()), 1));
  double tolerance = rtol / quadrature_part;
  while (true) {
    system_.refine({}, tolerance);
    solution_ = system_.solve(iteration_part * rtol * iteration_part * rtol);
    if (!solution_.positive_definite) {
      if (tolerance < finest_tolerance)
        throw std::runtime_error("the matrix of the conductors at rest is not positive definite");
      tolerance /= 100;
      continue;
    }
    error_ = largest_error(solution_, bodies_);
    show_progress(
        fmt::format("{} panels, error {:.2g} of {:g} asked for", mesh().panels().size(), error_, rtol));
    const double excess = error_ / rtol;
    if (excess <= 1 || !refine(excess, most_panels))
      return;
  }
}

/// Refines where the error indicators are large. Returns false if no more panels are allowed.
bool ConductorsAtRest::refine(double excess, std::size_t most_panels) {
  /// Factor by which a refinement aims below the allowed error.
  constexpr double margin = 1.25;
  const std::size_t panels = mesh().panels().size();
  if (panels >= most_panels)
    return false;
  const std::vector<bool> marked = doerfler_marking(mesh().groups(), solution_.error_indicators,
                                                    solution_.error_indicators.sum() / (margin * excess),
                                                    std::min(panels, most_panels - panels));
  if (marked.empty())
    return false;
  system_.refine_groups(marked, solution_.charges);
  return true;
}

}  // namespace fringe::detail
