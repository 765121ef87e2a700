#include "panel_system.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Cholesky>

#include "panel_coupling.hpp"
#include "panel_matrix.hpp"

namespace fringe::detail {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// The panels' quadratures do much better than they have to: between a plate and a cube at a fifth of its
/// size, at any of four levels, they changed no capacitance by more than a fiftieth of their tolerance.
constexpr double panel_tolerances = 10;

constexpr double unknown_tolerance = std::numeric_limits<double>::infinity();

/// More are never needed: the two spaces together make an error fall by a factor of some three every step.
constexpr int most_iterations = 200;

Index index_of(std::size_t k) {
  return static_cast<Index>(k);
}

ChargedBodies with_faces(const ChargedBodies& bodies) {
  ChargedBodies result = bodies;
  std::erase_if(result.bodies, [](const ChargedBody& body) { return body.faces.empty(); });
  return result;
}

}  // namespace

/// Unknowns are the functions of all faces, one face after the other, then the panels.
struct PanelSystem::Unknowns {
  std::vector<Index> first;  ///< of each face
  Index functions = 0;
  std::vector<Index> coarse;   ///< the faces' functions of the smaller space
  std::vector<Index> highest;  ///< the others
  MatrixXd net;                ///< net charges, a column for every conductor
};

/// The matrix of the faces' functions and the groups: those of the smaller space first, then the groups, then
/// the faces' others.
struct PanelSystem::Nested {
  VectorXd shares;  ///< of each panel in its group's area
  Eigen::LLT<MatrixXd> factor;
  std::vector<Eigen::LLT<MatrixXd>> groups;  ///< of each group's panels
  bool positive_definite = true;

  /// From all unknowns to those of the nested matrix: by what a density on each group is tested with.
  VectorXd restricted(const Unknowns& unknowns, const std::vector<PanelGroup>& all_groups,
                      const VectorXd& full) const {
    const auto group_count = index_of(all_groups.size()), coarse = index_of(unknowns.coarse.size());
    VectorXd result(unknowns.functions + group_count);
    for (Index k = 0; k < coarse; ++k)
      result[k] = full[unknowns.coarse[static_cast<std::size_t>(k)]];
    for (Index g = 0; g < group_count; ++g) {
      const auto first = index_of(all_groups[static_cast<std::size_t>(g)].first);
      const auto count = index_of(all_groups[static_cast<std::size_t>(g)].count);
      result[coarse + g] = full.segment(unknowns.functions + first, count).dot(shares.segment(first, count));
    }
    for (std::size_t k = 0; k < unknowns.highest.size(); ++k)
      result[coarse + group_count + index_of(k)] = full[unknowns.highest[k]];
    return result;
  }

  /// The transpose of restricted().
  VectorXd prolonged(const Unknowns& unknowns, const std::vector<PanelGroup>& all_groups,
                     const VectorXd& nested) const {
    const auto group_count = index_of(all_groups.size()), coarse = index_of(unknowns.coarse.size());
    VectorXd result(unknowns.functions + shares.size());
    for (Index k = 0; k < coarse; ++k)
      result[unknowns.coarse[static_cast<std::size_t>(k)]] = nested[k];
    for (Index g = 0; g < group_count; ++g) {
      const auto first = index_of(all_groups[static_cast<std::size_t>(g)].first);
      const auto count = index_of(all_groups[static_cast<std::size_t>(g)].count);
      result.segment(unknowns.functions + first, count) = nested[coarse + g] * shares.segment(first, count);
    }
    for (std::size_t k = 0; k < unknowns.highest.size(); ++k)
      result[unknowns.highest[k]] = nested[coarse + group_count + index_of(k)];
    return result;
  }

  /// What nearly inverts the whole matrix: the groups' common densities together, and each group by itself.
  VectorXd preconditioned(const Unknowns& unknowns, const std::vector<PanelGroup>& all_groups,
                          const VectorXd& residual) const {
    VectorXd result =
        prolonged(unknowns, all_groups, factor.solve(restricted(unknowns, all_groups, residual)));
    for (std::size_t g = 0; g < all_groups.size(); ++g) {
      const Index first = unknowns.functions + index_of(all_groups[g].first);
      const auto count = index_of(all_groups[g].count);
      result.segment(first, count) += groups[g].solve(residual.segment(first, count));
    }
    return result;
  }
};

PanelSystem::PanelSystem(const ChargedBodies& bodies)
    : bodies_(bodies), bodies_of_faces_(with_faces(bodies)), faces_(bodies_of_faces_),
      panel_tolerance_(unknown_tolerance), coupling_tolerance_(unknown_tolerance) {
  for (std::size_t body = 0; body < bodies.bodies.size(); ++body)
    if (bodies.bodies[body].faces.empty())
      mesh_.add(body, bodies.bodies[body].triangles);
}

void PanelSystem::refine_groups(const std::vector<bool>& marked, const MatrixXd& charges) {
  // Twice without a matrix between them leave no places that it has.
  if (is_refined_)
    panel_tolerance_ = unknown_tolerance;
  mesh_.refine(marked, charges);
  is_refined_ = true;
  coupling_tolerance_ = unknown_tolerance;
}

void PanelSystem::refine(const std::vector<FaceFunctions>& functions, double tolerance) {
  faces_.refine(functions, tolerance);
  if (mesh_.panels().empty())
    return;
  if (panel_tolerance_ > panel_tolerances * tolerance) {
    panel_tolerance_ = panel_tolerances * tolerance;
    panels_ = panel_matrix(mesh_.panels(), panel_tolerance_);
  } else if (is_refined_) {
    const MatrixXd before = std::move(panels_);
    panels_ = panel_matrix(mesh_.panels(), panel_tolerance_, {before, mesh_.places_before()});
  }
  is_refined_ = false;
  if (coupling_tolerance_ > tolerance || coupled_functions_ != functions)
    refine_coupling(functions, tolerance);
}

void PanelSystem::refine_coupling(const std::vector<FaceFunctions>& functions, double tolerance) {
  Index rows = 0;
  for (const FaceFunctions& face : functions)
    rows += face.count();
  coupling_.resize(rows, index_of(mesh_.panels().size()));
  Index row = 0;
  for (std::size_t face = 0; face < functions.size(); ++face) {
    coupling_.middleRows(row, functions[face].count()) =
        panel_coupling(faces_.face(face), functions[face], mesh_.panels(), tolerance);
    row += functions[face].count();
  }
  coupled_functions_ = functions;
  coupling_tolerance_ = tolerance;
}

PanelSystem::Unknowns PanelSystem::number() const {
  Unknowns unknowns;
  for (std::size_t face = 0; face < faces(); ++face) {
    unknowns.first.push_back(unknowns.functions);
    const FaceFunctions functions = faces_.functions(face);
    for (int k = 0; k < functions.count(); ++k)
      (is_coarse(functions, k) ? unknowns.coarse : unknowns.highest).push_back(unknowns.functions + k);
    unknowns.functions += functions.count();
  }
  unknowns.net =
      MatrixXd::Zero(unknowns.functions + index_of(mesh_.panels().size()), index_of(bodies_.names.size()));
  for (std::size_t face = 0; face < faces(); ++face)
    unknowns.net(unknowns.first[face], index_of(faces_.conductor(face))) = faces_.net_charge(face);
  for (const PanelGroup& group : mesh_.groups())
    unknowns.net.col(index_of(bodies_.bodies[group.body].conductor))
        .segment(unknowns.functions + index_of(group.first), index_of(group.count))
        .setOnes();
  return unknowns;
}

MatrixXd PanelSystem::face_matrix(const Unknowns& unknowns) const {
  MatrixXd matrix(unknowns.functions, unknowns.functions);
  for (std::size_t a = 0; a < faces(); ++a)
    for (std::size_t b = a; b < faces(); ++b) {
      const MatrixXd& block = faces_.block(a, b);
      matrix.block(unknowns.first[a], unknowns.first[b], block.rows(), block.cols()) = block;
      matrix.block(unknowns.first[b], unknowns.first[a], block.cols(), block.rows()) = block.transpose();
    }
  return matrix;
}

PanelSystem::Nested PanelSystem::nested_matrix(const Unknowns& unknowns, const MatrixXd& face_matrix) const {
  const std::vector<PanelGroup>& groups = mesh_.groups();
  const auto group_count = index_of(groups.size()), coarse = index_of(unknowns.coarse.size());
  Nested nested;
  nested.shares.resize(index_of(mesh_.panels().size()));
  for (const PanelGroup& group : groups) {
    double area = 0;
    for (std::size_t k = 0; k < group.count; ++k)
      area += mesh_.panels()[group.first + k].area;
    for (std::size_t k = 0; k < group.count; ++k)
      nested.shares[index_of(group.first + k)] = mesh_.panels()[group.first + k].area / area;
  }
  // Only the lower triangle is filled.
  MatrixXd matrix(unknowns.functions + group_count, unknowns.functions + group_count);
  const auto place = [&](std::size_t k) {
    return index_of(k) < coarse ? index_of(k) : index_of(k) + group_count;
  };
  std::vector<Index> functions = unknowns.coarse;
  functions.insert(functions.end(), unknowns.highest.begin(), unknowns.highest.end());
  for (std::size_t column = 0; column < functions.size(); ++column)
    for (std::size_t row = column; row < functions.size(); ++row)
      matrix(place(row), place(column)) = face_matrix(functions[row], functions[column]);
  VectorXd sums(group_count);
  for (std::size_t g = 0; g < groups.size(); ++g) {
    const auto first = index_of(groups[g].first), count = index_of(groups[g].count);
    const auto shares = nested.shares.segment(first, count);
    const VectorXd faces = coupling_.middleCols(first, count) * shares;
    for (std::size_t k = 0; k < functions.size(); ++k) {
      const Index at = place(k), group = coarse + index_of(g);
      matrix(std::max(at, group), std::min(at, group)) = faces[functions[k]];
    }
    // The groups before: whole columns above the diagonal.
    const VectorXd column = panels_.middleCols(first, count).topRows(first) * shares;
    for (std::size_t h = 0; h < g; ++h)
      matrix(coarse + index_of(g), coarse + index_of(h)) =
          column.segment(index_of(groups[h].first), index_of(groups[h].count))
              .dot(nested.shares.segment(index_of(groups[h].first), index_of(groups[h].count)));
    const MatrixXd own = panels_.block(first, first, count, count).selfadjointView<Eigen::Upper>();
    matrix(coarse + index_of(g), coarse + index_of(g)) = shares.dot(own * shares);
    nested.groups.emplace_back(own);
    nested.positive_definite &= nested.groups.back().info() == Eigen::Success;
  }
  nested.factor.compute(matrix);
  nested.positive_definite &= nested.factor.info() == Eigen::Success;
  return nested;
}

/// What a panel that was never divided would gain if it were: the energy of the charges that its quarters
/// take for what the potential lacks on them, without any net charge. Found for some of the panels, for all.
void PanelSystem::add_unseen(const Unknowns& unknowns, const MatrixXd& charges,
                             PanelSolution& solution) const {
  constexpr std::size_t most_samples = 96;
  std::vector<std::size_t> undivided;
  for (const PanelGroup& group : mesh_.groups())
    for (std::size_t k = 0; k < group.count && !group.is_quartered; ++k)
      undivided.push_back(group.first + k);
  if (undivided.empty())
    return;
  const std::size_t samples = std::min(most_samples, undivided.size());
  std::vector<Panel> targets;
  for (std::size_t k = 0; k < samples; ++k)
    for (const Triangle& quarter :
         quarters(mesh_.panels()[undivided[k * undivided.size() / samples]].corners))
      targets.push_back(make_panel(quarter));
  MatrixXd potentials = panel_potentials(targets, mesh_.panels(), solution.charges, panel_tolerance_);
  for (std::size_t face = 0; face < faces(); ++face)
    potentials +=
        panel_coupling(faces_.face(face), faces_.functions(face), targets, panel_tolerance_).transpose() *
        charges.middleRows(unknowns.first[face], faces_.functions(face).count());
  const Index conductors = charges.cols();
  MatrixXd gained = MatrixXd::Zero(conductors, conductors);
  for (std::size_t k = 0; k < samples; ++k) {
    const MatrixXd own =
        panel_matrix(std::span(targets).subspan(4 * k, 4), panel_tolerance_).selfadjointView<Eigen::Upper>();
    const MatrixXd lacking = potentials.middleRows(index_of(4 * k), 4);
    const Eigen::LLT<MatrixXd> factor(own);
    const MatrixXd answer = factor.solve(lacking);
    const VectorXd net = factor.solve(VectorXd::Ones(4));
    gained += lacking.transpose() * (answer - net * (answer.colwise().sum() / net.sum()));
  }
  gained *= static_cast<double>(undivided.size()) / static_cast<double>(samples);
  solution.all.coarse -= gained;

  const VectorXd own = solution.all.fine.diagonal();
  const double part = (gained.diagonal().array() / own.array()).maxCoeff();
  // Where there is more charge, there is more of it.
  VectorXd shares = VectorXd::Zero(solution.group_energies.size());
  for (std::size_t g = 0; g < mesh_.groups().size(); ++g) {
    const PanelGroup& group = mesh_.groups()[g];
    for (std::size_t k = group.first; k < group.first + group.count && !group.is_quartered; ++k)
      shares[index_of(g)] +=
          (solution.charges.row(index_of(k)).cwiseAbs2().array() / own.transpose().array()).maxCoeff() *
          panels_(index_of(k), index_of(k));
  }
  solution.group_energies += part * shares / shares.sum();
}

PanelSolution PanelSystem::solve(double accuracy) const {
  PanelSolution solution;
  if (mesh_.panels().empty()) {
    static_cast<GalerkinSolution&>(solution) = faces_.solve();
    const Index conductors = solution.all.fine.rows();
    solution.unfinished = MatrixXd::Zero(conductors, conductors);
    return solution;
  }
  const auto& groups = mesh_.groups();
  const Unknowns unknowns = number();
  const MatrixXd matrix = face_matrix(unknowns);
  const Nested nested = nested_matrix(unknowns, matrix);
  solution.positive_definite = nested.positive_definite;
  solution.sensors = faces_.solve_sensors();
  solution.positive_definite &= bodies_.sensors == 0 || solution.sensors.fine.size() > 0;
  if (!solution.positive_definite)
    return solution;

  const Index functions = unknowns.functions, panels = index_of(mesh_.panels().size());
  const Index size = functions + panels, conductors = unknowns.net.cols();
  const auto apply = [&](const VectorXd& charge) {
    VectorXd potential(size);
    potential.head(functions) = matrix * charge.head(functions) + coupling_ * charge.tail(panels);
    potential.tail(panels) = panels_.selfadjointView<Eigen::Upper>() * charge.tail(panels);
    potential.tail(panels) += coupling_.transpose() * charge.head(functions);
    return potential;
  };

  MatrixXd charges(size, conductors), residuals(size, conductors);
  VectorXd gains(conductors);
  MatrixXd smaller(index_of(unknowns.coarse.size() + groups.size()), conductors);
  for (Index c = 0; c < conductors; ++c) {
    VectorXd first = nested.restricted(unknowns, groups, unknowns.net.col(c));
    nested.factor.matrixL().solveInPlace(first);
    smaller.col(c) = first.head(smaller.rows());
    nested.factor.matrixU().solveInPlace(first);
    VectorXd charge = nested.prolonged(unknowns, groups, first);
    VectorXd residual = unknowns.net.col(c) - apply(charge);
    VectorXd step = nested.preconditioned(unknowns, groups, residual);
    double product = residual.dot(step), gain = 0;
    for (int iteration = 0; iteration < most_iterations; ++iteration) {
      const VectorXd potential = apply(step);
      const double energy = step.dot(potential);
      if (!(product > 0))
        break;
      if (!(energy > 0)) {
        solution.positive_definite = false;
        return solution;
      }
      charge += product / energy * step;
      residual -= product / energy * potential;
      gain = product / energy * product;
      if (gain <= accuracy * charge.dot(unknowns.net.col(c)))
        break;
      const VectorXd next = nested.preconditioned(unknowns, groups, residual);
      const double next_product = residual.dot(next);
      step = next + next_product / product * step;
      product = next_product;
    }
    charges.col(c) = charge;
    residuals.col(c) = residual;
    gains[c] = gain;
  }
  solution.all.coarse = smaller.transpose() * smaller;
  // Right to second order in what the iteration left.
  const MatrixXd found = unknowns.net.transpose() * charges + charges.transpose() * residuals;
  solution.all.fine = (found + found.transpose()) / 2;
  solution.unfinished = (gains * gains.transpose()).cwiseSqrt();
  solution.charges = charges.bottomRows(panels);

  const VectorXd own = solution.all.fine.diagonal();
  solution.highest.assign(faces(), Eigen::Vector2d::Zero());
  MatrixXd norms = MatrixXd::Zero(index_of(faces()), conductors);
  for (std::size_t face = 0; face < faces(); ++face) {
    const FaceFunctions along = faces_.functions(face);
    for (int k = 0; k < along.count(); ++k) {
      const auto row = charges.row(unknowns.first[face] + k);
      norms.row(index_of(face)) += row.cwiseAbs2();
      const double energy =
          (row.cwiseAbs2().array() / own.transpose().array()).maxCoeff() * faces_.block(face, face)(k, k);
      if (k / along.v >= coarse_functions(along.u))
        solution.highest[face][0] += energy;
      if (k % along.v >= coarse_functions(along.v))
        solution.highest[face][1] += energy;
    }
  }
  solution.group_energies = VectorXd::Zero(index_of(groups.size()));
  for (std::size_t g = 0; g < groups.size(); ++g) {
    const auto first = index_of(groups[g].first), count = index_of(groups[g].count);
    const MatrixXd block = panels_.block(first, first, count, count).selfadjointView<Eigen::Upper>();
    for (Index c = 0; c < conductors; ++c) {
      VectorXd details = solution.charges.col(c).segment(first, count);
      details -= details.sum() * nested.shares.segment(first, count);
      solution.group_energies[index_of(g)] =
          std::max(solution.group_energies[index_of(g)], details.dot(block * details) / own[c]);
    }
  }

  add_unseen(unknowns, charges, solution);

  norms = norms.cwiseSqrt();
  solution.quadrature_effect = faces_.quadrature_effect(norms);
  const MatrixXd absolute = solution.charges.cwiseAbs();
  MatrixXd felt(panels, conductors);
  for (Index c = 0; c < conductors; ++c)
    felt.col(c) = panels_.selfadjointView<Eigen::Upper>() * absolute.col(c);
  for (std::size_t face = 0; face < faces(); ++face) {
    const Eigen::RowVectorXd largest =
        coupling_.middleRows(unknowns.first[face], faces_.functions(face).count())
            .cwiseAbs()
            .colwise()
            .maxCoeff();
    felt += 2 * largest.transpose() * norms.row(index_of(face));
  }
  const MatrixXd effect = absolute.transpose() * felt;
  solution.quadrature_effect += panel_tolerances / 4 * (effect + effect.transpose());
  return solution;
}

}  // namespace fringe::detail
