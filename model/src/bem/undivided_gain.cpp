#include "bem/undivided_gain.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

#include <Eigen/Cholesky>

#include "bem/potentials_beside.hpp"
#include "bem/single_layer_panels.hpp"

namespace fringe::detail {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Returns a root of the energy of what four quarters of an interface lack, by the
/// potentials that lack there.
MatrixXd root_of_interface(const Panel& quarter, double mean, const MatrixXd& lacking) {
  return std::sqrt(energy_of_potential_step * std::sqrt(quarter.area) * mean) *
         (lacking.rowwise() - lacking.colwise().mean());
}

/// Returns a root of the energy of charges that add up to zero on four quarters of a conductor, by the
/// potentials that lack there.
MatrixXd root_of_charges(std::span<const Panel> quarters, double mean, const MatrixXd& lacking,
                         double tolerance) {
  const MatrixXd own = single_layer_matrix(quarters, tolerance).selfadjointView<Eigen::Upper>();
  const Eigen::LLT<MatrixXd> factor(own);
  MatrixXd result = factor.matrixL().solve(lacking);
  const VectorXd net = factor.matrixL().solve(VectorXd::Ones(4)).normalized();
  result -= net * (net.transpose() * result);
  return std::sqrt(mean) * result;
}

/// Returns what the energies that a body's undivided panels gain are divided among its groups by (rows:
/// groups, columns: conductors).
MatrixXd weights_of_groups(const PanelMesh& mesh, const InsulatedUnknowns& unknowns, const MatrixXd& values) {
  const std::vector<Index> group_of = mesh.group_of_panels();
  MatrixXd result = MatrixXd::Zero(index_of(mesh.groups().size()), values.cols());
  for (Index k = 0; k < unknowns.size(); ++k) {
    const Index panel = unknowns.panels[static_cast<std::size_t>(k)];
    const Index group = group_of[static_cast<std::size_t>(panel)];
    if (mesh.groups()[static_cast<std::size_t>(group)].is_quartered)
      continue;
    const double size = std::sqrt(mesh.panels()[static_cast<std::size_t>(panel)].area);
    if (unknowns.is_charge(k))
      result.row(group) += (values.row(k).array().square() / size).matrix();
    else
      result.row(group).array() += size * size * size;
  }
  return result;
}

}  // namespace

UndividedGain undivided_gain(const PanelMesh& mesh, const InsulatedBodies& bodies,
                             const InsulatedEquations& equations, const QuartersWithAngles& quarters,
                             const MatrixXd& values, double tolerance) {
  const InsulatedUnknowns& unknowns = equations.unknowns;
  const SampledQuarters& sampled = quarters.sampled;
  UndividedGain result{MatrixXd::Zero(index_of(sampled.panels.size()), values.cols()),
                       MatrixXd::Zero(index_of(mesh.groups().size()), values.cols())};
  if (sampled.panels.empty())
    return result;
  const std::vector<Index> place = places_of_panels(mesh, unknowns);
  const MatrixXd potentials = potentials_of_panels(bodies, unknowns, values);
  std::vector<Index> parents;
  std::vector<AngleTarget> targets;
  for (const std::size_t parent : sampled.parents) {
    parents.push_back(place[parent]);
    targets.push_back(place[parent] < 0 ? AngleTarget{1, AngleSums::unknown}
                                        : equations.target(place[parent]));
  }
  const MatrixXd lacking = -potentials_beside(mesh, bodies, equations, sampled.panels, quarters.double_layer,
                                              targets, values, tolerance);
  MatrixXd of_bodies = MatrixXd::Zero(
      index_of(*std::max_element(sampled.bodies.begin(), sampled.bodies.end())) + 1, values.cols());
  for (std::size_t k = 0; k < sampled.panels.size(); k += 4) {
    const Index parent = parents[k];
    if (parent < 0 || unknowns.kind(parent) == PartKind::film)
      continue;
    const double mean = targets[k].mean;
    const MatrixXd here = lacking.middleRows(index_of(k), 4).rowwise() + potentials.row(parent);
    const MatrixXd root =
        std::sqrt(sampled.weight) *
        (unknowns.is_charge(parent)
             ? root_of_charges(std::span(sampled.panels).subspan(k, 4), mean, here, tolerance)
             : root_of_interface(sampled.panels[k], mean, here));
    result.roots.middleRows(index_of(k), 4) = root;
    of_bodies.row(index_of(sampled.bodies[k])) += root.colwise().squaredNorm();
  }
  // Among the groups of a body the energy is divided like these weights.
  result.groups = weights_of_groups(mesh, unknowns, values);
  MatrixXd sums = MatrixXd::Zero(of_bodies.rows(), values.cols());
  const auto body_of = [&](std::size_t group) { return index_of(mesh.groups()[group].body); };
  for (std::size_t g = 0; g < mesh.groups().size(); ++g)
    if (body_of(g) < sums.rows())
      sums.row(body_of(g)) += result.groups.row(index_of(g));
  for (std::size_t g = 0; g < mesh.groups().size(); ++g)
    for (Index c = 0; c < values.cols(); ++c)
      if (double& own = result.groups(index_of(g), c); own > 0)
        own *= body_of(g) < sums.rows() ? of_bodies(body_of(g), c) / sums(body_of(g), c) : 0;
  return result;
}

}  // namespace fringe::detail
