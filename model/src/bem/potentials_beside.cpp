#include "bem/potentials_beside.hpp"

#include <cstddef>
#include <numeric>

#include "bem/single_layer_panels.hpp"

namespace fringe::detail {

using Eigen::Index;
using Eigen::MatrixXd;

std::vector<Index> places_of_panels(const PanelMesh& mesh, const InsulatedUnknowns& unknowns) {
  std::vector<Index> result(mesh.panels().size(), -1);
  for (std::size_t k = 0; k < unknowns.panels.size(); ++k)
    result[static_cast<std::size_t>(unknowns.panels[k])] = index_of(k);
  return result;
}

MatrixXd potentials_of_panels(const InsulatedBodies& bodies, const InsulatedUnknowns& unknowns,
                              const MatrixXd& values) {
  MatrixXd result = values;
  for (Index k = 0; k < unknowns.size(); ++k) {
    if (!unknowns.is_charge(k))
      continue;
    result.row(k).setZero();
    if (unknowns.kind(k) != PartKind::conductor)
      continue;
    const auto body = static_cast<std::size_t>(unknowns.body[static_cast<std::size_t>(k)]);
    result(k, index_of(bodies.conductors.bodies[body].conductor)) = 1;
  }
  return result;
}

MatrixXd potentials_beside(const PanelMesh& mesh, const InsulatedBodies& bodies,
                           const InsulatedEquations& equations, std::span<const Panel> targets,
                           const DoubleLayer& double_layer, const std::vector<AngleTarget>& places,
                           const MatrixXd& values, double tolerance) {
  const InsulatedUnknowns& unknowns = equations.unknowns;
  if (targets.empty())
    return MatrixXd::Zero(0, values.cols());
  const MatrixXd potentials = potentials_of_panels(bodies, unknowns, values);
  MatrixXd charges = MatrixXd::Zero(index_of(mesh.panels().size()), values.cols());
  std::vector<Index> interfaces;
  for (Index k = 0; k < unknowns.size(); ++k) {
    const auto at = static_cast<std::size_t>(k);
    if (unknowns.is_charge(k))
      charges.row(unknowns.panels[at]) = values.row(k);
    if (unknowns.states[at].ratios.behind != unknowns.states[at].ratios.before)
      interfaces.push_back(k);
  }
  MatrixXd result = panel_potentials(targets, mesh.panels(), charges, tolerance, equations.threads);
  std::vector<Index> all(targets.size());
  std::iota(all.begin(), all.end(), 0);
  const auto column = [&](Index k) {
    return double_layer.column(all, unknowns.panels[static_cast<std::size_t>(k)]);
  };
  const AngleSums angles(unknowns, equations.components, places, column);
  for (const Index k : interfaces)
    result += angles.corrected(k, column(k)) * potentials.row(k);
  for (Index row = 0; row < result.rows(); ++row)
    result.row(row) /= places[static_cast<std::size_t>(row)].mean;
  return result;
}

}  // namespace fringe::detail
