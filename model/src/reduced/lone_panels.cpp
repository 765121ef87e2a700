#include "lone_panels.hpp"

#include <algorithm>
#include <numeric>
#include <utility>
#include <vector>

#include "../boundary/panel_matrix.hpp"
#include "fringe/error.hpp"

namespace fringe::detail {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::RowVectorXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

/// As in boundary elements (model/BOUNDARY_ELEMENTS.md, section 9): twice the change from one density on each
/// group to one on each panel.
constexpr double error_per_change = 2;

/// The matrix's elements are much better known than the energies.
constexpr double tolerance_per_accuracy = 0.2;

Index at_index(std::size_t k) {
  return static_cast<Index>(k);
}

/// The panels' shares in their groups' areas.
VectorXd area_shares(const PanelMesh& mesh) {
  VectorXd shares(at_index(mesh.panels().size()));
  for (const PanelGroup& group : mesh.groups()) {
    const auto first = at_index(group.first), count = at_index(group.count);
    for (std::size_t k = group.first; k < group.first + group.count; ++k)
      shares[at_index(k)] = mesh.panels()[k].area;
    shares.segment(first, count) /= shares.segment(first, count).sum();
  }
  return shares;
}

/// The energies that charges of one density on each group reach.
MatrixXd group_energies(const LonePanels& panels, const MatrixXd& potentials) {
  const auto& groups = panels.mesh.groups();
  const VectorXd shares = area_shares(panels.mesh);
  const MatrixXd all = panels.matrix.selfadjointView<Eigen::Upper>();
  MatrixXd felt(all.rows(), at_index(groups.size())), own(felt.cols(), felt.cols()),
      asked(felt.cols(), potentials.cols());
  for (std::size_t g = 0; g < groups.size(); ++g) {
    const auto first = at_index(groups[g].first), count = at_index(groups[g].count);
    felt.col(at_index(g)) = all.middleCols(first, count) * shares.segment(first, count);
    asked.row(at_index(g)) = shares.segment(first, count).transpose() * potentials.middleRows(first, count);
  }
  for (std::size_t g = 0; g < groups.size(); ++g) {
    const auto first = at_index(groups[g].first), count = at_index(groups[g].count);
    own.row(at_index(g)) = shares.segment(first, count).transpose() * felt.middleRows(first, count);
  }
  const MatrixXd reached = own.llt().matrixL().solve(asked);
  return reached.transpose() * reached;
}

/// What every group's charges hold more than one density would, relative to the whole.
VectorXd detail_energies(const LonePanels& panels, const MatrixXd& responses, const VectorXd& own) {
  const auto& groups = panels.mesh.groups();
  VectorXd energies = VectorXd::Zero(at_index(groups.size()));
  for (std::size_t g = 0; g < groups.size(); ++g) {
    const auto first = at_index(groups[g].first), count = at_index(groups[g].count);
    VectorXd shares(count);
    for (Index k = 0; k < count; ++k)
      shares[k] = panels.mesh.panels()[groups[g].first + static_cast<std::size_t>(k)].area;
    shares /= shares.sum();
    const MatrixXd block = panels.matrix.block(first, first, count, count).selfadjointView<Eigen::Upper>();
    for (Index c = 0; c < responses.cols(); ++c) {
      VectorXd details = responses.col(c).segment(first, count);
      details -= details.sum() * shares;
      energies[at_index(g)] = std::max(energies[at_index(g)], details.dot(block * details) / own[c]);
    }
  }
  return energies;
}

/// The groups that hold the most; empty if they would make too many panels.
std::vector<bool> groups_to_refine(const PanelMesh& mesh, const VectorXd& energies, double allowed,
                                   std::size_t most) {
  constexpr double greater_part = 0.75;
  /// What a refined group goes on to hold, of what it held.
  constexpr double left = 0.4;
  std::vector<std::size_t> order(mesh.groups().size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return energies[at_index(a)] > energies[at_index(b)];
  });
  const double total = energies.sum();
  double taken = 0;
  std::size_t size = mesh.panels().size();
  std::vector<bool> marked(order.size(), false);
  for (const std::size_t group : order) {
    size += PanelMesh::growth(mesh.groups()[group]);
    if (size > most)
      return taken > 0 ? marked : std::vector<bool>{};
    marked[group] = true;
    taken += energies[at_index(group)];
    if (taken >= greater_part * total || total - (1 - left) * taken <= allowed)
      break;
  }
  return marked;
}

/// Potentials of degree 0 and 1 on the panels.
MatrixXd plain_potentials(const PanelMesh& mesh) {
  MatrixXd potentials(at_index(mesh.panels().size()), 4);
  for (std::size_t k = 0; k < mesh.panels().size(); ++k)
    potentials.row(at_index(k)) << 1, mesh.panels()[k].centre.transpose();
  return potentials;
}

/// With finer quadratures where these make the matrix none of energies.
void factorise(LonePanels& panels) {
  /// Below this, rounding decides over the elements.
  constexpr double finest_tolerance = 1e-13;
  panels.factor.compute(panels.matrix.transpose());
  while (panels.factor.info() != Eigen::Success) {
    if (panels.tolerance < finest_tolerance)
      throw InputError("its triangles lie upon each other");
    panels.tolerance /= 100;
    panels.matrix = panel_matrix(panels.mesh.panels(), panels.tolerance);
    panels.factor.compute(panels.matrix.transpose());
  }
}

}  // namespace

LonePanels lone_panels(std::span<const Triangle> triangles, double accuracy, std::size_t most_panels) {
  LonePanels panels;
  panels.tolerance = tolerance_per_accuracy * accuracy;
  panels.mesh.add(0, triangles);
  panels.matrix = panel_matrix(panels.mesh.panels(), panels.tolerance);
  while (true) {
    factorise(panels);
    const MatrixXd potentials = plain_potentials(panels.mesh);
    const MatrixXd responses = panels.factor.solve(potentials);
    VectorXd own = potentials.cwiseProduct(responses).colwise().sum();
    const VectorXd change = own - group_energies(panels, potentials).diagonal();
    // A flat body has almost no response across it, whose part that is missing does not matter.
    constexpr double least_response = 0.1;
    own.tail(3) = own.tail(3).cwiseMax(least_response * own.tail(3).maxCoeff());
    const double error = error_per_change * (change.array() / own.array()).maxCoeff();
    if (error <= accuracy)
      return panels;
    const VectorXd energies = detail_energies(panels, responses, own);
    const std::vector<bool> marked =
        groups_to_refine(panels.mesh, energies, energies.sum() * accuracy / error, most_panels);
    if (marked.empty())
      return panels;
    const MatrixXd before = std::move(panels.matrix);
    panels.mesh.refine(marked, responses);
    panels.matrix =
        panel_matrix(panels.mesh.panels(), panels.tolerance, {before, panels.mesh.places_before()});
  }
}

MatrixXd missing_energies(const LonePanels& panels, const MatrixXd& potentials, const MatrixXd& responses,
                          const std::function<RowVectorXd(const Vector3d&)>& at) {
  const MatrixXd reached = potentials.transpose() * responses;
  MatrixXd missing = reached - group_energies(panels, potentials);

  // What triangles that were never divided hide, found for some of them (section 9).
  constexpr std::size_t most_samples = 96;
  std::vector<std::size_t> undivided;
  for (const PanelGroup& group : panels.mesh.groups())
    for (std::size_t k = 0; k < group.count && !group.is_quartered; ++k)
      undivided.push_back(group.first + k);
  const std::size_t samples = std::min(most_samples, undivided.size());
  if (samples > 0) {
    std::vector<Panel> targets;
    for (std::size_t k = 0; k < samples; ++k)
      for (const Triangle& quarter :
           quarters(panels.mesh.panels()[undivided[k * undivided.size() / samples]].corners))
        targets.push_back(make_panel(quarter));
    MatrixXd lacking = panel_potentials(targets, panels.mesh.panels(), -responses, panels.tolerance);
    for (std::size_t k = 0; k < targets.size(); ++k)
      lacking.row(at_index(k)) += at(targets[k].centre);
    MatrixXd gained = MatrixXd::Zero(missing.rows(), missing.cols());
    for (std::size_t k = 0; k < samples; ++k) {
      const MatrixXd own = panel_matrix(std::span(targets).subspan(4 * k, 4), panels.tolerance)
                               .selfadjointView<Eigen::Upper>();
      const MatrixXd here = lacking.middleRows(at_index(4 * k), 4);
      const Eigen::LLT<MatrixXd> factor(own);
      const MatrixXd answer = factor.solve(here);
      const VectorXd net = factor.solve(VectorXd::Ones(4));
      gained += here.transpose() * (answer - net * (answer.colwise().sum() / net.sum()));
    }
    missing += gained * (static_cast<double>(undivided.size()) / static_cast<double>(samples));
  }
  return (missing + missing.transpose()) / 2;
}

}  // namespace fringe::detail
