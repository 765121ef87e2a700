#include "panel_energies.hpp"

#include <algorithm>
#include <span>
#include <vector>

#include <Eigen/Cholesky>

#include "panel_coupling.hpp"
#include "panel_matrix.hpp"

namespace fringe::detail {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

std::vector<std::size_t> undivided_panels(const PanelMesh& mesh) {
  std::vector<std::size_t> undivided;
  for (const PanelGroup& group : mesh.groups())
    for (std::size_t k = 0; k < group.count && !group.is_quartered; ++k)
      undivided.push_back(group.first + k);
  return undivided;
}

/// The energy of the charges that the quarters of some panels, four after four, take for what the potential
/// lacks on them, without any net charge.
MatrixXd energy_of_quarters(const PanelEquations& equations, std::span<const Panel> quarters,
                            const MatrixXd& charges, double tolerance) {
  const PanelUnknowns& unknowns = equations.unknowns;
  const GalerkinSystem& faces = equations.face_system;
  MatrixXd potentials =
      panel_potentials(quarters, equations.mesh.panels(),
                       charges.bottomRows(index_of(equations.mesh.panels().size())), tolerance);
  for (std::size_t face = 0; face < faces.faces(); ++face)
    potentials += panel_coupling(faces.face(face), faces.functions(face), quarters, tolerance).transpose() *
                  charges.middleRows(unknowns.first[face], faces.functions(face).count());
  MatrixXd gained = MatrixXd::Zero(charges.cols(), charges.cols());
  for (std::size_t k = 0; k < quarters.size(); k += 4) {
    const MatrixXd own = panel_matrix(quarters.subspan(k, 4), tolerance).selfadjointView<Eigen::Upper>();
    const MatrixXd lacking = potentials.middleRows(index_of(k), 4);
    const Eigen::LLT<MatrixXd> factor(own);
    const MatrixXd answer = factor.solve(lacking);
    const VectorXd net = factor.solve(VectorXd::Ones(4));
    gained += lacking.transpose() * (answer - net * (answer.colwise().sum() / net.sum()));
  }
  return gained;
}

}  // namespace

VectorXd group_energies(const PanelEquations& equations, const VectorXd& shares, const MatrixXd& charges,
                        const VectorXd& own) {
  const std::vector<PanelGroup>& groups = equations.mesh.groups();
  VectorXd energies = VectorXd::Zero(index_of(groups.size()));
  for (std::size_t g = 0; g < groups.size(); ++g) {
    const auto first = index_of(groups[g].first), count = index_of(groups[g].count);
    const MatrixXd block = equations.panels.block(first, first, count, count).selfadjointView<Eigen::Upper>();
    for (Index c = 0; c < charges.cols(); ++c) {
      VectorXd details = charges.col(c).segment(equations.unknowns.functions + first, count);
      details -= details.sum() * shares.segment(first, count);
      energies[index_of(g)] = std::max(energies[index_of(g)], details.dot(block * details) / own[c]);
    }
  }
  return energies;
}

UnseenEnergy unseen_energy(const PanelEquations& equations, const MatrixXd& charges, const VectorXd& own,
                           double tolerance) {
  /// Found for so many panels, for all.
  constexpr std::size_t most_samples = 96;
  const PanelMesh& mesh = equations.mesh;
  const std::vector<std::size_t> undivided = undivided_panels(mesh);
  if (undivided.empty())
    return {};
  const std::size_t samples = std::min(most_samples, undivided.size());
  std::vector<Panel> targets;
  for (std::size_t k = 0; k < samples; ++k)
    for (const Triangle& quarter : quarters(mesh.panels()[undivided[k * undivided.size() / samples]].corners))
      targets.push_back(make_panel(quarter));
  UnseenEnergy unseen{energy_of_quarters(equations, targets, charges, tolerance) *
                          (static_cast<double>(undivided.size()) / static_cast<double>(samples)),
                      VectorXd::Zero(index_of(mesh.groups().size()))};
  const double part = (unseen.gained.diagonal().array() / own.array()).maxCoeff();
  // Where there is more charge, there is more of it.
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
