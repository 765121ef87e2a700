#include "bem/panel_system.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <span>
#include <stdexcept>
#include <utility>

#include "bem/group_densities.hpp"
#include "bem/proximity_refinement.hpp"
#include "bem/single_layer_panels.hpp"
#include "bem/two_level_preconditioner.hpp"
#include "numeric/cholesky.hpp"
#include "numeric/parallel.hpp"
#include "readings/asked_error.hpp"
#include "readings/maxwell_matrix.hpp"
#include "readings/readings.hpp"

namespace fringe::detail {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Ratio of the panels' quadrature tolerance to the faces'. The panels' quadratures are much better than
/// their tolerance: between a plate and a cube at a fifth of its size, at any of four levels, they changed no
/// capacitance by more than a fiftieth of it; of nine robot arms none by more than a twentieth.
constexpr double panel_tolerances = 25;

/// Stands for a matrix that has to be evaluated.
constexpr double unknown_tolerance = std::numeric_limits<double>::infinity();

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

void require_positive_definite(bool is_positive_definite) {
  if (!is_positive_definite)
    throw std::runtime_error("the matrix of the boundary elements is not positive definite");
}

CoarseSpace coarse_space_of(const HierarchicalMatrix& matrix, const VectorXd& areas,
                            const std::vector<std::size_t>& bodies) {
  const Index together = std::max(least_together, (matrix.size() - 1) / coarse_functions_wanted + 1);
  return coarse_space(matrix, areas, bodies, together);
}

}  // namespace

PanelSystem::PanelSystem(const ChargedBodies& bodies, const PanelGrading& grading, std::size_t threads)
    : bodies_(bodies), threads_(threads), faces_(bodies),
      mesh_(std::make_shared<const HiddenSurface>(bodies)), panel_tolerance_(unknown_tolerance),
      coupling_tolerance_(unknown_tolerance) {
  for (std::size_t body = 0; body < bodies.bodies.size(); ++body)
    if (const auto* surface = std::get_if<TriangleSurface>(&bodies.bodies[body].surface))
      mesh_.add(body, surface->triangles, grading, surface->round ? &*surface->round : nullptr, threads);
  refine_by_proximity(mesh_, bodies, grading.most_panels);
}

void PanelSystem::refine_groups(const std::vector<int>& steps, const MatrixXd& charges) {
  // After two refinements without a matrix between them, the places are not those of the matrix.
  if (is_refined_)
    panel_tolerance_ = coupling_tolerance_ = unknown_tolerance;
  const Index panels = index_of(mesh_.panels().size()), columns = last_charges_.cols();
  MatrixXd last(panels, columns + last_background_.cols());
  if (columns > 0)
    last.leftCols(columns) = last_charges_.bottomRows(panels);
  if (last_background_.cols() > 0)
    last.rightCols(last_background_.cols()) = last_background_.bottomRows(panels);
  const MatrixXd carried = mesh_.refine(steps, charges, last);
  const auto carry = [&](MatrixXd& all, const auto& of_panels) {
    if (all.size() == 0)
      return;
    const Index functions = all.rows() - panels;
    all.conservativeResize(functions + of_panels.rows(), Eigen::NoChange);
    all.bottomRows(of_panels.rows()) = of_panels;
  };
  carry(last_charges_, carried.leftCols(columns));
  carry(last_background_, carried.rightCols(last_background_.cols()));
  is_refined_ = true;
}

/// Returns the charges by which an iteration begins, from those of the last solution: functions of faces that
/// are new have none.
MatrixXd PanelSystem::begun(const MatrixXd& last, Index functions) const {
  if (last.size() == 0)
    return {};
  const Index panels = index_of(mesh_.panels().size());
  MatrixXd result = MatrixXd::Zero(functions + panels, last.cols());
  result.bottomRows(panels) = last.bottomRows(panels);
  Index to = 0, from = 0;
  for (std::size_t face = 0; face < faces(); ++face) {
    const FaceFunctions now = faces_.functions(face), before = last_functions_[face];
    for (Index u = 0; u < std::min(now.u, before.u); ++u)
      for (Index v = 0; v < std::min(now.v, before.v); ++v)
        result.row(to + u * now.v + v) = last.row(from + u * before.v + v);
    to += now.count();
    from += before.count();
  }
  return result;
}

void PanelSystem::refine(const std::vector<FaceFunctions>& functions, double tolerance) {
  faces_.refine(functions, tolerance);
  if (mesh_.panels().empty())
    return;
  if (panel_tolerance_ > panel_tolerances * tolerance || is_refined_) {
    const bool is_finer = panel_tolerance_ > panel_tolerances * tolerance;
    panel_tolerance_ = std::min(panel_tolerance_, panel_tolerances * tolerance);
    panels_ = std::make_unique<PanelOperator>(mesh_, panel_tolerance_, is_finer ? nullptr : panels_.get(),
                                              threads_);
    // Panels that coincide still do after a refinement.
    set_ridge(is_finer ? 0 : std::exchange(ridge_, 0));
  }
  refine_coupling(functions, tolerance);
  is_refined_ = false;
}

/// Evaluates the elements of panels and functions that are new, or all for a finer tolerance.
void PanelSystem::refine_coupling(const std::vector<FaceFunctions>& functions, double tolerance) {
  /// Number of panels in one call.
  constexpr std::size_t together = 8;
  const bool is_finer = coupling_tolerance_ > tolerance;
  if (!is_finer && !is_refined_ && coupled_functions_ == functions)
    return;
  coupling_tolerance_ = std::min(coupling_tolerance_, tolerance);
  const std::vector<Panel>& panels = mesh_.panels();
  const Eigen::MatrixXf before = std::move(coupling_);
  Index rows = 0;
  for (const FaceFunctions& face : functions)
    rows += face.count();
  coupling_.resize(rows, index_of(panels.size()));
  std::vector<std::size_t> known, missing;
  const auto place_before = [&](std::size_t k) {
    return is_refined_ ? mesh_.places_before()[k] : index_of(k);
  };
  for (std::size_t k = 0; k < panels.size(); ++k)
    (is_finer || place_before(k) == PanelMesh::no_place ? missing : known).push_back(k);

  const auto evaluate = [&](const std::vector<std::size_t>& places, bool are_known) {
    parallel_for((places.size() + together - 1) / together, threads_, [&](std::size_t part) {
      const auto here =
          std::span(places).subspan(part * together, std::min(together, places.size() - part * together));
      std::vector<Panel> targets;
      for (const std::size_t k : here)
        targets.push_back(panels[k]);
      Index row = 0, row_before = 0;
      for (std::size_t face = 0; face < functions.size(); ++face) {
        const Index count = functions[face].count();
        if (are_known && coupled_functions_[face] == functions[face]) {
          for (const std::size_t k : here)
            coupling_.col(index_of(k)).segment(row, count) =
                before.col(place_before(k)).segment(row_before, count);
        } else {
          const MatrixXd block =
              single_layer_block(faces_.face(face), functions[face], targets, coupling_tolerance_);
          for (std::size_t k = 0; k < here.size(); ++k)
            coupling_.col(index_of(here[k])).segment(row, count) = block.col(index_of(k)).cast<float>();
        }
        row += count;
        row_before += are_known ? coupled_functions_[face].count() : 0;
      }
    });
  };
  evaluate(missing, false);
  evaluate(known, true);
  coupled_functions_ = functions;
}

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

/// Returns the charge on each body (rows) from the charges of all unknowns.
MatrixXd PanelSystem::body_charges(const PanelUnknowns& unknowns, const MatrixXd& charges) const {
  MatrixXd result = MatrixXd::Zero(index_of(bodies_.bodies.size()), charges.cols());
  for (std::size_t face = 0; face < faces(); ++face)
    result.row(index_of(faces_.body(face))) += faces_.net_charge(face) * charges.row(unknowns.first[face]);
  for (const PanelGroup& group : mesh_.groups())
    result.row(index_of(group.body)) +=
        charges.middleRows(unknowns.functions + index_of(group.first), index_of(group.count)).colwise().sum();
  return result;
}

std::vector<MatrixXd> PanelSystem::charges_of_faces(const PanelUnknowns& unknowns,
                                                    const MatrixXd& charges) const {
  std::vector<MatrixXd> of_faces;
  if (charges.size() == 0)
    return of_faces;
  for (std::size_t face = 0; face < faces(); ++face)
    of_faces.emplace_back(charges.middleRows(unknowns.first[face], faces_.functions(face).count()));
  return of_faces;
}

/// Returns the possible change of the capacitances for quadrature errors of all blocks, relative to their
/// tolerances. `charges` are those of all unknowns.
MatrixXd PanelSystem::quadrature_effect(const PanelUnknowns& unknowns, const MatrixXd& charges) const {
  const MatrixXd norms = norms_of_faces(charges_of_faces(unknowns, charges));
  const MatrixXd absolute = charges.bottomRows(index_of(mesh_.panels().size())).cwiseAbs();
  if (absolute.isZero(0))
    return faces_.quadrature_effect(norms);
  MatrixXd felt = panels_->apply(absolute);
  for (std::size_t face = 0; face < faces(); ++face) {
    const Eigen::RowVectorXd largest =
        coupling_.middleRows(unknowns.first[face], faces_.functions(face).count())
            .cwiseAbs()
            .colwise()
            .maxCoeff()
            .cast<double>();
    felt += 2 * largest.transpose() * norms.row(index_of(face));
  }
  const MatrixXd effect = absolute.transpose() * felt;
  const MatrixXd of_panels = panel_tolerances / 4 * (effect + effect.transpose());
  return faces() == 0 ? of_panels : faces_.quadrature_effect(norms) + of_panels;
}

/// The matrix of the faces and the spaces of fewer functions, with their matrices. The equations with and
/// without the targets share them.
struct PanelSystem::Spaces {
  MatrixXd functions;  ///< the matrix of the faces' functions; none without panels
  Restriction to_groups;
  HierarchicalMatrix groups;  ///< the matrix of one density on each group
  CoarseSpace of_panels;
  CoarseSpace of_groups;
};

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

/// Solves in both spaces where there are no panels. With the functions of the coarse space first, its matrix
/// is the leading block of the whole one, so that one factorisation serves both.
PanelSystem::Solved PanelSystem::solve_functions(const PanelUnknowns& unknowns) const {
  const auto is_present = [&](Index k) { return unknowns.present.size() == 0 || unknowns.present[k] != 0; };
  std::vector<Index> own;
  std::copy_if(unknowns.coarse.begin(), unknowns.coarse.end(), std::back_inserter(own), is_present);
  const Index coarse = index_of(own.size());
  std::vector<bool> is_coarse(static_cast<std::size_t>(unknowns.functions), false);
  for (const Index k : unknowns.coarse)
    is_coarse[static_cast<std::size_t>(k)] = true;
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
    space->missing = space->missing_of_change = VectorXd::Zero(lower.cols());
  result.charges = MatrixXd::Zero(unknowns.functions, lower.cols());
  result.charges(own, Eigen::all) = factor.solve_upper(std::move(lower));
  return result;
}

/// Solves in the whole space and in the coarse one. Both have the unknowns of the faces first, then those of
/// the panels or the groups in the order of the tree. The iteration begins with the charges `begun`; with
/// none if these are empty. With a background, `begun` are the changes by the targets, and the solution is
/// the background with these changes.
PanelSystem::Solved PanelSystem::solve_equations(const PanelUnknowns& unknowns, const Spaces& spaces,
                                                 double accuracy, const MatrixXd& begun,
                                                 const Solved* background) const {
  if (mesh_.panels().empty())
    return solve_functions(unknowns);
  const std::vector<Index>& places = panels_->tree().panels();
  const Index functions = unknowns.functions, panels = index_of(places.size());
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
    if (matrix.present.size() > 0 && matrix.present.tail(matrix.unknowns.size()).isZero(0))
      return detail::solve_functions(matrix, net);
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

/// Returns the energies that panels which were never divided would gain from division, estimated from the
/// sampled ones, between all columns of the charges with all bodies and, after them, of those with the
/// unknowns that are present.
MatrixXd PanelSystem::gained_by_division(const SampledQuarters& sampled, const PanelUnknowns& unknowns,
                                         const MatrixXd& charges, const MatrixXd& of_present) const {
  // The conductors' own potentials are constant: charges whose sum vanishes do not see them.
  MatrixXd both(unknowns.net.rows(), charges.cols() + of_present.cols());
  if (charges.cols() > 0)
    both.leftCols(charges.cols()) = charges;
  if (of_present.cols() > 0)
    both.rightCols(of_present.cols()) = of_present;
  MatrixXd missing =
      panel_potentials(sampled.panels, mesh_.panels(), both.bottomRows(index_of(mesh_.panels().size())),
                       panel_tolerance_, threads_);
  for (std::size_t face = 0; face < faces(); ++face)
    missing +=
        single_layer_block(faces_.face(face), functions(face), sampled.panels, panel_tolerance_).transpose() *
        both.middleRows(unknowns.first[face], functions(face).count());
  for (std::size_t k = 0; k < sampled.panels.size() && of_present.cols() > 0; ++k)
    if (unknowns.present[unknowns.functions + index_of(sampled.parents[k])] == 0)
      missing.row(index_of(k)).tail(of_present.cols()).setZero();
  return energy_of_quarters(sampled, missing, panel_tolerance_);
}

void PanelSystem::set_ridge(double ridge) {
  panels_->scale_diagonal((1 + ridge) / (1 + ridge_));
  ridge_ = ridge;
}

/// Returns the energy that the ridge takes from charges of the panels, all counted as positive. What it
/// changes is that in first order.
MatrixXd PanelSystem::ridge_effect(const MatrixXd& charges) const {
  MatrixXd effect = MatrixXd::Zero(charges.cols(), charges.cols());
  if (ridge_ == 0)
    return effect;
  VectorXd weights(charges.rows());
  for (Index k = 0; k < weights.size(); ++k)
    weights[k] = ridge_ / (1 + ridge_) * panels_->self(static_cast<std::size_t>(k));
  return charges.cwiseAbs().transpose() * weights.asDiagonal() * charges.cwiseAbs();
}

PanelSolution PanelSystem::solve(double accuracy, double most_ridge, double change_part) {
  /// Ratio of the ridges that are tried. One that is just large enough for a positive definite matrix leaves
  /// panels that nearly coincide large charges of both signs.
  constexpr double step = 10;
  constexpr int steps = 2;
  PanelSolution solution = solve_once(accuracy, change_part);
  if (mesh_.panels().empty())
    return solution;
  double ridge = most_ridge * std::pow(step, -(steps - 1));
  for (int k = 0; k < steps && !solution.positive_definite && most_ridge > 0; ++k, ridge *= step)
    if (ridge > ridge_) {
      set_ridge(ridge);
      solution = solve_once(accuracy, change_part);
    }
  if (!solution.positive_definite)
    set_ridge(0);
  return solution;
}

PanelSolution PanelSystem::solve_once(double accuracy, double change_part) {
  PanelSolution solution;
  const PanelUnknowns unknowns = number_unknowns();
  const bool has_readings = !bodies_.readings.empty();
  const Spaces spaces = this->spaces();
  if (count_of(bodies_, Role::sensor) > 0 && !sensors_have_panels(bodies_)) {
    solution.sensors = solve_sensors(spaces, accuracy);
    solution.positive_definite = solution.sensors.positive_definite;
    if (!solution.positive_definite)
      return solution;
  }
  Solved background;
  PanelUnknowns machine = unknowns;
  MatrixXd start = begun(last_charges_, unknowns.functions);
  if (has_readings) {
    machine = unknowns_of(unknowns, [](const ChargedBody& body) { return !body.is_target; });
    const MatrixXd begun_background = begun(last_background_, unknowns.functions);
    background = solve_equations(machine, spaces, accuracy * change_part, begun_background, nullptr);
    solution.positive_definite = background.positive_definite();
    if (!solution.positive_definite)
      return solution;
    if (start.size() > 0)
      start -= begun_background;
  }
  const Solved solved =
      solve_equations(unknowns, spaces, accuracy, start, has_readings ? &background : nullptr);
  solution.positive_definite = solved.positive_definite();
  if (!solution.positive_definite)
    return solution;
  solution.all = {solved.fine.matrix, solved.coarse.matrix};
  solution.iteration_error = solved.fine.iteration_error();
  solution.charges = solved.charges.bottomRows(index_of(mesh_.panels().size()));
  solution.coarse_charges = solved.coarse_charges;
  solution.body_charges = body_charges(unknowns, solved.charges);
  const MatrixXd at = potentials(solution.all.fine, bodies_);
  const MatrixXd kept_charges = solution.charges * at;
  solution.ridge_effect = ridge_effect(kept_charges);
  const VectorXd own = asked_energies(solution.all.fine, bodies_);
  const VectorXd shares = area_shares(mesh_);
  std::vector<MatrixXd> blocks;
  for (const PanelGroup& group : mesh_.groups())
    blocks.push_back(panels_->block_of_group(group));
  Eigen::ArrayXXd scales_of_entries = error_scales((solution.all.fine * at).topRows(at.cols()), bodies_);
  scales_of_entries.matrix().diagonal() =
      scales_of_entries.matrix().diagonal().cwiseMin(own.head(scales_of_entries.rows()));
  // Floating conductors have no entries, but their energies may be asked for.
  solution.error_indicators =
      largest_parts(detail_energies(mesh_, blocks, shares, solution.charges), own) +
      facet_indicators(mesh_, bodies_, kept_charges, scales_of_entries)
          .cwiseMax(largest_parts(facet_energies(mesh_, bodies_, solution.charges), own));
  VectorXd scales;
  if (has_readings) {
    solution.background = {background.fine.matrix, background.coarse.matrix};
    solution.background_iteration_error = background.fine.iteration_error();
    solution.change_iteration_error = solved.fine.iteration_error_of_change();
    const MatrixXd reading_charges =
        detail::reading_charges(solved.charges, solution.all.fine, background.charges,
                                solution.background.fine, bodies_)
            .all();
    solution.reading_charges = reading_charges.bottomRows(index_of(mesh_.panels().size()));
    solution.reading_ridge_effect = ridge_effect(solution.reading_charges);
    solution.face_reading_charges = charges_of_faces(unknowns, reading_charges);
    solution.reading_quadrature_effect = quadrature_effect(unknowns, reading_charges);
    const MatrixXd details = detail_energies(mesh_, blocks, shares, solution.reading_charges);
    solution.reading_details = energies_of_pairs(details);
    if (faces() > 0)
      solution.reading_details += faces_.detail_energies(solution.face_reading_charges);
    scales = change_scales(solution.all, solution.background, bodies_);
    solution.error_indicators = solution.error_indicators.cwiseMax(
        largest_parts_of_change(details, scales) +
        largest_parts_of_change(facet_energies(mesh_, bodies_, solution.reading_charges), scales));
  }
  solution.highest = faces_.highest_energies(
      {charges_of_faces(unknowns, solved.charges), solution.face_reading_charges, own, scales});
  if (const SampledQuarters sampled = sampled_quarters(mesh_); !sampled.panels.empty()) {
    const Index columns = solved.charges.cols(), without = background.charges.cols();
    const MatrixXd gained = gained_by_division(sampled, machine, solved.charges, background.charges);
    solution.all.coarse -= gained.topLeftCorner(columns, columns);
    if (without > 0)
      solution.background.coarse -= gained.bottomRightCorner(without, without);
    solution.error_indicators +=
        unrefined_indicators(mesh_, blocks, solution.charges, own,
                             (gained.diagonal().head(columns).array() / own.array()).maxCoeff());
  }
  solution.quadrature_effect = quadrature_effect(unknowns, solved.charges);
  last_charges_ = solved.charges;
  last_background_ = std::move(background.charges);
  last_functions_.clear();
  for (std::size_t face = 0; face < faces(); ++face)
    last_functions_.push_back(functions(face));
  return solution;
}

PanelSolution PanelSystem::solve_definite(const std::vector<FaceFunctions>& functions, double& tolerance,
                                          double accuracy, double most_ridge, double change_part) {
  /// Finest relative tolerance of the quadratures. Below it, rounding errors dominate the matrix elements.
  constexpr double finest_tolerance = 1e-13;
  while (true) {
    refine(functions, tolerance);
    PanelSolution found = solve(accuracy, most_ridge, change_part);
    if (found.positive_definite)
      return found;
    if (tolerance < finest_tolerance)
      require_positive_definite(false);
    tolerance /= 100;
  }
}

SensorsAlone PanelSystem::solve_sensors(double accuracy) const {
  SensorsAlone result = solve_sensors(spaces(), accuracy);
  require_positive_definite(result.positive_definite);
  return result;
}

SensorsAlone PanelSystem::solve_sensors(const Spaces& spaces, double accuracy) const {
  const PanelUnknowns unknowns = unknowns_of(
      number_unknowns(), [&](const ChargedBody& body) { return bodies_.role(body) == Role::sensor; });
  const Solved solved = solve_equations(unknowns, spaces, accuracy, {}, nullptr);
  SensorsAlone result;
  result.positive_definite = solved.positive_definite();
  if (!result.positive_definite)
    return result;
  result.matrix = {solved.fine.matrix, solved.coarse.matrix};
  if (const SampledQuarters sampled = sampled_quarters(mesh_);
      !sampled.panels.empty() && sensors_have_panels(bodies_))
    result.matrix.coarse -= gained_by_division(sampled, unknowns, {}, solved.charges);
  result.quadrature_effect = quadrature_effect(unknowns, solved.charges);
  result.iteration_error = solved.fine.iteration_error();
  return result;
}

}  // namespace fringe::detail
