#include "bem/error_indicators.hpp"

#include <algorithm>
#include <vector>

#include "bem/group_densities.hpp"
#include "bem/single_layer_face_panel.hpp"
#include "bem/single_layer_panels.hpp"
#include "bem/unrefined_elements.hpp"

namespace fringe::detail {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Returns the mean potentials of all charges on panels that need not be the system's own.
MatrixXd potentials_on(const std::vector<Panel>& targets, const PanelEquations& equations,
                       const MatrixXd& charges, double tolerance) {
  const PanelUnknowns& unknowns = equations.unknowns;
  const GalerkinSystem& faces = equations.face_system;
  MatrixXd potentials =
      panel_potentials(targets, equations.mesh.panels(),
                       charges.bottomRows(index_of(equations.mesh.panels().size())), tolerance);
  for (std::size_t face = 0; face < faces.faces(); ++face)
    potentials += panel_coupling(faces.face(face), faces.functions(face), targets, tolerance).transpose() *
                  charges.middleRows(unknowns.first[face], faces.functions(face).count());
  return potentials;
}

}  // namespace

VectorXd group_energies(const PanelMesh& mesh, const MatrixXd& panels, const VectorXd& shares,
                        const MatrixXd& charges, const VectorXd& own) {
  const std::vector<PanelGroup>& groups = mesh.groups();
  VectorXd energies = VectorXd::Zero(index_of(groups.size()));
  for (std::size_t g = 0; g < groups.size(); ++g) {
    const auto first = index_of(groups[g].first), count = index_of(groups[g].count);
    const MatrixXd block = matrix_of_group(groups[g], panels);
    for (Index c = 0; c < charges.cols(); ++c) {
      VectorXd details = charges.col(c).segment(first, count);
      details -= details.sum() * shares.segment(first, count);
      energies[index_of(g)] = std::max(energies[index_of(g)], details.dot(block * details) / own[c]);
    }
  }
  return energies;
}

UnseenEnergy unseen_energy(const PanelEquations& equations, const MatrixXd& charges, const VectorXd& own,
                           double tolerance) {
  const PanelMesh& mesh = equations.mesh;
  const SampledQuarters sampled = sampled_quarters(mesh);
  if (sampled.panels.empty())
    return {};
  // The conductors' own potentials are constant: charges whose sum vanishes do not see them.
  UnseenEnergy unseen{
      energy_of_quarters(sampled, potentials_on(sampled.panels, equations, charges, tolerance), tolerance),
      VectorXd::Zero(index_of(mesh.groups().size()))};
  const double part = (unseen.gained.diagonal().array() / own.array()).maxCoeff();
  // Groups with more charge get a larger part of the gained energy.
  for (std::size_t g = 0; g < mesh.groups().size(); ++g) {
    const PanelGroup& group = mesh.groups()[g];
    for (std::size_t k = group.first; k < group.first + group.count && !group.is_quartered; ++k) {
      const auto row = charges.row(equations.unknowns.functions + index_of(k));
      unseen.groups[index_of(g)] += (row.cwiseAbs2().array() / own.transpose().array()).maxCoeff() *
                                    equations.panels(index_of(k), index_of(k));
    }
  }
  unseen.groups *= part / unseen.groups.sum();
  return unseen;
}

}  // namespace fringe::detail
