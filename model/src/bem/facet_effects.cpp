#include "bem/facet_effects.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <optional>

#include "bem/potentials_beside.hpp"

namespace fringe::detail {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::RowVectorXd;
using Eigen::Vector3d;

/// Distance of the copies from a panel, relative to its size.
constexpr double steps_per_size = 0.7;

Panel shifted(const Panel& panel, const Vector3d& by) {
  Panel result = panel;
  for (Vector3d& corner : result.corners)
    corner += by;
  result.centre += by;
  return result;
}

double step_beside(const Panel& panel) {
  return steps_per_size * std::sqrt(panel.area);
}

/// Returns the roots of what a panel of a round conductor lacks, three rows.
MatrixXd root_of_conductor(const RoundShape& shape, const Panel& panel, const Ratios& ratios,
                           const RowVectorXd& charges) {
  const double outside = shape.is_thin() ? (ratios.behind + ratios.before) / 2 : ratios.before;
  MatrixXd result = MatrixXd::Zero(BesideFacets::copies, charges.cols());
  result.row(0) = std::sqrt(shape.lack_per_squared_charge(panel) / outside) * charges;
  return result;
}

}  // namespace

BesideFacets beside_facets(const PanelMesh& mesh, const InsulatedBodies& bodies) {
  /// Largest sample.
  constexpr std::size_t most = 96;
  const std::size_t conductors = bodies.conductors.bodies.size();
  std::vector<std::size_t> panels;
  std::vector<double> depths;
  for (const PanelGroup& group : mesh.groups()) {
    if (group.body < conductors || group.body >= conductors + bodies.insulators.size())
      continue;
    const std::optional<RoundShape>& round = bodies.insulators[group.body - conductors].round;
    for (std::size_t k = group.first; round && k < group.first + group.count; ++k)
      if (const double depth = round->depth(mesh.panels()[k].corners); depth > 0) {
        panels.push_back(k);
        depths.push_back(depth);
      }
  }
  BesideFacets result;
  const std::size_t count = std::min(most, panels.size());
  for (std::size_t k = 0; k < count; ++k) {
    const std::size_t at = k * panels.size() / count;
    const Panel& panel = mesh.panels()[panels[at]];
    const double step = step_beside(panel);
    const Vector3d normal = unit_normal(panel.corners);
    const Vector3d along = (panel.corners[1] - panel.corners[0]).normalized();
    result.panels.push_back(panels[at]);
    result.depths.push_back(depths[at] * static_cast<double>(panels.size()) / static_cast<double>(count));
    result.beside.push_back(shifted(panel, step * normal));
    result.beside.push_back(shifted(panel, step * (normal + along)));
    result.beside.push_back(shifted(panel, step * (normal + normal.cross(along))));
  }
  return result;
}

MatrixXd facet_effects(const PanelMesh& mesh, const InsulatedBodies& bodies,
                       const InsulatedEquations& equations, const BesideFacets& facets,
                       const MatrixXd& values, double tolerance) {
  const InsulatedUnknowns& unknowns = equations.unknowns;
  const std::vector<Index> place = places_of_panels(mesh, unknowns);
  std::vector<MatrixXd> roots;
  // Every panel has rows whether it is there or not: roots with and without some bodies are compared.
  for (const PanelGroup& group : mesh.groups()) {
    if (group.body >= bodies.conductors.bodies.size())
      continue;
    const RoundShape* const round = round_shape_of(bodies.conductors.bodies[group.body].surface);
    for (std::size_t panel = group.first; round != nullptr && panel < group.first + group.count; ++panel) {
      const Index own = place[panel];
      const bool is_conductor = own >= 0 && unknowns.kind(own) == PartKind::conductor;
      roots.push_back(is_conductor ? root_of_conductor(*round, mesh.panels()[panel],
                                                       unknowns.states[static_cast<std::size_t>(own)].ratios,
                                                       values.row(own))
                                   : MatrixXd(MatrixXd::Zero(BesideFacets::copies, values.cols())));
    }
  }
  std::vector<AngleTarget> targets;
  for (const std::size_t panel : facets.panels) {
    const Index own = place[panel];
    const double outside = own < 0 ? 1 : unknowns.states[static_cast<std::size_t>(own)].ratios.before;
    targets.insert(targets.end(), BesideFacets::copies, {outside, AngleSums::unknown});
  }
  const MatrixXd potentials = potentials_beside(mesh, bodies, equations, facets.beside, facets.double_layer,
                                                targets, values, tolerance);
  for (std::size_t k = 0; k < facets.panels.size(); ++k) {
    // Parts that lie on conductors, or are not there, are no unknowns.
    const Index own = place[facets.panels[k]], first = BesideFacets::copies * index_of(k);
    MatrixXd& root = roots.emplace_back(MatrixXd::Zero(BesideFacets::copies, values.cols()));
    if (own < 0)
      continue;
    const Panel& panel = mesh.panels()[facets.panels[k]];
    const Ratios& ratios = unknowns.states[static_cast<std::size_t>(own)].ratios;
    root << (values.row(own) - potentials.row(first)) * std::sqrt(ratios.before / ratios.behind),
        potentials.row(first) - potentials.row(first + 1), potentials.row(first) - potentials.row(first + 2);
    root *= std::sqrt(std::abs(ratios.behind - ratios.before) / (4 * std::numbers::pi) * facets.depths[k] *
                      panel.area) /
            step_beside(panel);
  }
  MatrixXd result(BesideFacets::copies * index_of(roots.size()), values.cols());
  for (std::size_t k = 0; k < roots.size(); ++k)
    result.middleRows(BesideFacets::copies * index_of(k), BesideFacets::copies) = roots[k];
  return result;
}

}  // namespace fringe::detail
