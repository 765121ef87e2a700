/// The equations of a PanelSystem: its unknowns, and their solution in the whole space and the coarse one.

#include <algorithm>
#include <iterator>
#include <numeric>
#include <utility>

#include "bem/group_densities.hpp"
#include "bem/panel_system.hpp"
#include "bem/two_level_preconditioner.hpp"
#include "numeric/cholesky.hpp"

namespace fringe::detail {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Number of functions of the preconditioner's coarse space that are aimed at: their matrix is factorised in
/// a tenth of a second.
constexpr Index coarse_functions_wanted = 1000;

/// Ratio of the accuracies of the iterations for the conductors that are not asked for and for those that
/// are. The entries between both miss the geometric mean.
constexpr double accuracy_of_others = 100;

/// Fewest unknowns for each function of the coarse space.
constexpr Index least_together = 4;

/// Numbers in the order of a tree.
std::vector<std::size_t> bodies_of_panels(const PanelMesh& mesh, const ClusterTree& tree) {
  std::vector<std::size_t> bodies;
  for (const Index g : tree.groups()) {
    const PanelGroup& group = mesh.groups()[static_cast<std::size_t>(g)];
    bodies.insert(bodies.end(), group.count, group.body);
  }
  return bodies;
}

/// Returns the panels' shares in one density on each of their groups, as a restriction in the order of a
/// tree.
Restriction restriction_to_groups(const PanelMesh& mesh, const ClusterTree& tree, const VectorXd& shares) {
  Restriction restriction{{}, shares(tree.panels())};
  for (std::size_t place = 0; place < tree.groups().size(); ++place)
    restriction.target.insert(restriction.target.end(),
                              mesh.groups()[static_cast<std::size_t>(tree.groups()[place])].count,
                              index_of(place));
  return restriction;
}

CoarseSpace coarse_space_of(const HierarchicalMatrix& matrix, const VectorXd& areas,
                            const std::vector<std::size_t>& bodies) {
  const Index together = std::max(least_together, (matrix.size() - 1) / coarse_functions_wanted + 1);
  return coarse_space(matrix, areas, bodies, together);
}

}  // namespace

/// Returns the lower triangle of the matrix of some of the faces' functions, in this order.
MatrixXd PanelSystem::face_matrix(const PanelUnknowns& unknowns, const std::vector<Index>& order) const {
  std::vector<Index> place(static_cast<std::size_t>(unknowns.functions), -1);
  for (std::size_t k = 0; k < order.size(); ++k)
    place[static_cast<std::size_t>(order[k])] = index_of(k);
  MatrixXd matrix(index_of(order.size()), index_of(order.size()));
  for (std::size_t a = 0; a < faces(); ++a)
    for (std::size_t b = a; b < faces(); ++b) {
      const MatrixXd& block = faces_.block(a, b);
      for (Index k = 0; k < block.cols(); ++k) {
        const Index column = place[static_cast<std::size_t>(unknowns.first[b] + k)];
        for (Index i = 0; i < block.rows() && column >= 0; ++i)
          if (const Index row = place[static_cast<std::size_t>(unknowns.first[a] + i)]; row >= 0)
            matrix(std::max(row, column), std::min(row, column)) = block(i, k);
      }
    }
  return matrix;
}

PanelSystem::Spaces PanelSystem::spaces() const {
  if (mesh_.panels().empty())
    return {};
  const PanelUnknowns unknowns = number_unknowns();
  std::vector<Index> all(static_cast<std::size_t>(unknowns.functions));
  std::iota(all.begin(), all.end(), Index{0});
  MatrixXd functions = face_matrix(unknowns, all).selfadjointView<Eigen::Lower>();
  const ClusterTree& tree = panels_->tree();
  const std::vector<std::size_t> bodies = bodies_of_panels(mesh_, tree);
  VectorXd areas(index_of(bodies.size()));
  for (Index place = 0; place < areas.size(); ++place)
    areas[place] =
        mesh_.panels()[static_cast<std::size_t>(tree.panels()[static_cast<std::size_t>(place)])].area;
  std::vector<ClusterRange> ranges;
  for (const TreeCluster& cluster : tree.clusters())
    ranges.push_back(cluster.groups);
  Restriction to_groups = restriction_to_groups(mesh_, tree, area_shares(mesh_));
  HierarchicalMatrix groups = panels_->matrix().restricted(to_groups, std::move(ranges));
  VectorXd group_areas = VectorXd::Zero(groups.size());
  std::vector<std::size_t> group_bodies(static_cast<std::size_t>(groups.size()));
  for (std::size_t k = 0; k < bodies.size(); ++k) {
    group_areas[to_groups.target[k]] += areas[index_of(k)];
    group_bodies[static_cast<std::size_t>(to_groups.target[k])] = bodies[k];
  }
  CoarseSpace of_panels = coarse_space_of(panels_->matrix(), areas, bodies);
  CoarseSpace of_groups = coarse_space_of(groups, group_areas, group_bodies);
  return {std::move(functions), std::move(to_groups), std::move(groups), std::move(of_panels),
          std::move(of_groups)};
}

PanelUnknowns PanelSystem::number_unknowns() const {
  PanelUnknowns unknowns;
  for (std::size_t face = 0; face < faces(); ++face) {
    unknowns.first.push_back(unknowns.functions);
    for (int k = 0; k < functions(face).count(); ++k)
      if (is_coarse(functions(face), k))
        unknowns.coarse.push_back(unknowns.functions + k);
    unknowns.functions += functions(face).count();
  }
  unknowns.net = MatrixXd::Zero(unknowns.functions + index_of(mesh_.panels().size()),
                                index_of(bodies_.conductors.size()));
  for (std::size_t face = 0; face < faces(); ++face)
    unknowns.net(unknowns.first[face], index_of(bodies_.bodies[faces_.body(face)].conductor)) =
        faces_.net_charge(face);
  for (const PanelGroup& group : mesh_.groups())
    unknowns.net.col(index_of(bodies_.bodies[group.body].conductor))
        .segment(unknowns.functions + index_of(group.first), index_of(group.count))
        .setOnes();
  return unknowns;
}

/// Returns the unknowns with those of other bodies left out, and net charges of the conductors that are not
/// grounded.
PanelUnknowns PanelSystem::unknowns_of(PanelUnknowns unknowns,
                                       const std::function<bool(const ChargedBody&)>& is_there) const {
  unknowns.present = VectorXd::Ones(unknowns.net.rows());
  for (std::size_t face = 0; face < faces(); ++face)
    if (!is_there(bodies_.bodies[faces_.body(face)]))
      unknowns.present.segment(unknowns.first[face], functions(face).count()).setZero();
  for (const PanelGroup& group : mesh_.groups())
    if (!is_there(bodies_.bodies[group.body]))
      unknowns.present.segment(unknowns.functions + index_of(group.first), index_of(group.count)).setZero();
  for (std::size_t k = 0; k < bodies_.conductors.size(); ++k) {
    if (bodies_.conductors[k].role == Role::grounded)
      unknowns.net.col(index_of(k)).setZero();
    else
      unknowns.net.col(index_of(k)).array() *= unknowns.present.array();
  }
  return unknowns;
}

/// Solves in both spaces where no panels are there, but `groups` of them may be in the coarse space. With the
/// functions of the coarse space first, its matrix is the leading block of the whole one, so that one
/// factorisation serves both.
PanelSystem::Solved PanelSystem::solve_functions(const PanelUnknowns& unknowns, Index groups) const {
  const auto is_present = [&](Index k) { return unknowns.present.size() == 0 || unknowns.present[k] != 0; };
  const auto coarse_functions = index_of(unknowns.coarse.size()), columns = unknowns.net.cols();
  std::vector<bool> is_coarse(static_cast<std::size_t>(unknowns.functions), false);
  std::vector<Index> own, rows_in_coarse;
  for (Index k = 0; k < coarse_functions; ++k) {
    const Index function = unknowns.coarse[static_cast<std::size_t>(k)];
    is_coarse[static_cast<std::size_t>(function)] = true;
    if (is_present(function)) {
      own.push_back(function);
      rows_in_coarse.push_back(k);
    }
  }
  const Index coarse = index_of(own.size());
  for (Index k = 0; k < unknowns.functions; ++k)
    if (!is_coarse[static_cast<std::size_t>(k)] && is_present(k))
      own.push_back(k);
  Solved result;
  const Cholesky factor(face_matrix(unknowns, own));
  result.fine.positive_definite = factor.is_positive_definite();
  if (!result.positive_definite())
    return result;
  MatrixXd lower = factor.solve_lower(unknowns.net(own, Eigen::all));
  result.fine.matrix = lower.transpose() * lower;
  result.coarse.matrix = lower.topRows(coarse).transpose() * lower.topRows(coarse);
  for (SpaceSolution* const space : {&result.fine, &result.coarse})
    space->missing = space->missing_of_change = VectorXd::Zero(columns);
  result.coarse.charges = MatrixXd::Zero(coarse_functions + groups, columns);
  const auto leading = factor.factor().topLeftCorner(coarse, coarse).triangularView<Eigen::Lower>();
  const MatrixXd of_coarse = leading.transpose().solve(lower.topRows(coarse));
  result.coarse.charges(rows_in_coarse, Eigen::all) = of_coarse;
  result.charges = MatrixXd::Zero(unknowns.net.rows(), columns);
  result.charges(own, Eigen::all) = factor.solve_upper(std::move(lower));
  // Panels have no charge, in the order of the mesh as in that of the tree.
  result.fine.charges = result.charges;
  result.coarse_charges = MatrixXd::Zero(index_of(mesh_.panels().size()), columns);
  result.present = unknowns.present;
  result.present_in_coarse = VectorXd::Zero(coarse_functions + groups);
  result.present_in_coarse(rows_in_coarse).setOnes();
  return result;
}

/// Solves in the whole space and in the coarse one. Both have the unknowns of the faces first, then those of
/// the panels or the groups in the order of the tree. The iteration begins with the charges `begun`; with
/// none if these are empty. With a background, `begun` are the changes by the targets, and the solution is
/// the background with these changes.
PanelSystem::Solved PanelSystem::solve_equations(const PanelUnknowns& unknowns, const Spaces& spaces,
                                                 double accuracy, const MatrixXd& begun,
                                                 const Solved* background) const {
  const Index functions = unknowns.functions, panels = index_of(mesh_.panels().size());
  if (panels == 0 || (unknowns.present.size() > 0 && unknowns.present.tail(panels).isZero(0)))
    return solve_functions(unknowns, spaces.groups.size());
  const std::vector<Index>& places = panels_->tree().panels();
  std::vector<Index> order(static_cast<std::size_t>(functions + panels));
  std::iota(order.begin(), order.begin() + functions, Index{0});
  for (Index place = 0; place < panels; ++place)
    order[static_cast<std::size_t>(functions + place)] = functions + places[static_cast<std::size_t>(place)];
  VectorXd accuracies(unknowns.net.cols());
  for (Index c = 0; c < accuracies.size(); ++c)
    accuracies[c] =
        accuracy * (bodies_.conductors[static_cast<std::size_t>(c)].is_asked ? 1 : accuracy_of_others);

  Solved result;
  const auto solve = [&](const BorderedMatrix& matrix, const CoarseSpace& coarse, const MatrixXd& net,
                         MatrixXd start, const SpaceSolution* without) {
    const TwoLevelPreconditioner preconditioner(matrix, coarse, panel_tolerance_, threads_);
    if (!preconditioner.is_positive_definite()) {
      SpaceSolution none;
      none.positive_definite = false;
      return none;
    }
    if (without == nullptr)
      return solve_space(matrix, preconditioner, net, accuracies, std::move(start));
    return solve_with_targets(matrix, preconditioner, net, accuracies, std::move(start), *without,
                              &matrix.unknowns == &spaces.groups ? background->present_in_coarse
                                                                 : background->present);
  };
  const BorderedMatrix matrix{spaces.functions, coupling_(Eigen::all, places), panels_->matrix(),
                              unknowns.present.size() > 0 ? VectorXd(unknowns.present(order)) : VectorXd()};
  const MatrixXd right_sides = unknowns.net(order, Eigen::all);
  result.fine = solve(matrix, spaces.of_panels, right_sides,
                      begun.size() > 0 ? MatrixXd(begun(order, Eigen::all))
                                       : MatrixXd(MatrixXd::Zero(right_sides.rows(), right_sides.cols())),
                      background != nullptr ? &background->fine : nullptr);
  if (!result.positive_definite())
    return result;
  result.charges.resize(right_sides.rows(), right_sides.cols());
  result.charges(order, Eigen::all) = result.fine.charges;
  result.present = matrix.present;

  const Restriction& to_groups = spaces.to_groups;
  const auto coarse_functions = index_of(unknowns.coarse.size());
  MatrixXd coupling = MatrixXd::Zero(coarse_functions, spaces.groups.size());
  MatrixXd net = MatrixXd::Zero(coarse_functions + spaces.groups.size(), right_sides.cols()), start = net;
  VectorXd present = matrix.present.size() > 0 ? VectorXd(net.rows()) : VectorXd();
  const MatrixXd begun_by =
      background != nullptr ? MatrixXd(result.fine.charges - background->fine.charges) : result.fine.charges;
  for (Index k = 0; k < coarse_functions; ++k) {
    const Index function = unknowns.coarse[static_cast<std::size_t>(k)];
    net.row(k) = right_sides.row(function);
    start.row(k) = begun_by.row(function);
    if (present.size() > 0)
      present[k] = matrix.present[function];
  }
  for (Index k = 0; k < panels; ++k) {
    const Index group = to_groups.target[static_cast<std::size_t>(k)];
    for (Index row = 0; row < coarse_functions; ++row)
      coupling(row, group) +=
          to_groups.weights[k] *
          static_cast<double>(matrix.coupling(unknowns.coarse[static_cast<std::size_t>(row)], k));
    net.row(coarse_functions + group) += to_groups.weights[k] * right_sides.row(functions + k);
    start.row(coarse_functions + group) += begun_by.row(functions + k);
    if (present.size() > 0)
      present[coarse_functions + group] = matrix.present[functions + k];
  }
  const BorderedMatrix coarse_matrix{matrix.functions(unknowns.coarse, unknowns.coarse),
                                     coupling.cast<float>(), spaces.groups, std::move(present)};
  result.coarse = solve(coarse_matrix, spaces.of_groups, net, std::move(start),
                        background != nullptr ? &background->coarse : nullptr);
  if (!result.positive_definite())
    return result;
  result.present_in_coarse = coarse_matrix.present;
  result.coarse_charges.resize(panels, right_sides.cols());
  for (Index k = 0; k < panels; ++k)
    result.coarse_charges.row(places[static_cast<std::size_t>(k)]) =
        to_groups.weights[k] *
        result.coarse.charges.row(coarse_functions + to_groups.target[static_cast<std::size_t>(k)]);
  return result;
}

}  // namespace fringe::detail
