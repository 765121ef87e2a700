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

/// Distance of a copy from its panel, relative to its size.
constexpr double steps_per_size = 0.7;

/// Error per added effect of the facets of an interface whose panels follow the shape. The fields are those
/// of a sample of panels. Where they do not follow it, the next order may be as large as the effect: two
/// balls of 8 segments, 2 mm apart and of permittivity 30, missed 1.4 times what was added.
constexpr double error_per_followed_interface = 0.6;

/// Largest fall of a potential (V) beside a panel that is believed. Between conductors at 1 V and 0 V it is
/// at most 1, and coarse panels miss little of that. Where more is found, the sum of solid angles has failed,
/// and the jump of a high permittivity has multiplied its error.
constexpr double most_fall = 10;

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

/// Returns how much the potential falls over a step along two directions of a panel's plane, by the
/// potentials of its group. It is the same on both sides, but outside of a body of high permittivity it grows
/// at once, and the jump of the permittivity multiplies it.
MatrixXd falls_along(const PanelMesh& mesh, const InsulatedUnknowns& unknowns,
                     const std::vector<Index>& place, const PanelGroup& group, const Panel& panel,
                     const MatrixXd& values) {
  std::vector<Index> own;
  for (std::size_t k = group.first; k < group.first + group.count; ++k)
    if (place[k] >= 0 && !unknowns.is_charge(place[k]))
      own.push_back(place[k]);
  if (own.size() < 3)
    return MatrixXd::Zero(2, values.cols());
  const Vector3d along = (panel.corners[1] - panel.corners[0]).normalized();
  const Vector3d across = unit_normal(panel.corners).cross(along);
  MatrixXd places(index_of(own.size()), 3);
  for (std::size_t k = 0; k < own.size(); ++k) {
    const auto at = static_cast<std::size_t>(unknowns.panels[static_cast<std::size_t>(own[k])]);
    const Vector3d from = mesh.panels()[at].centre - panel.centre;
    places.row(index_of(k)) << 1, from.dot(along), from.dot(across);
  }
  const MatrixXd potentials = values(own, Eigen::all);
  const MatrixXd fitted = places.colPivHouseholderQr().solve(potentials);
  return step_beside(panel) * fitted.bottomRows(2);
}

}  // namespace

BesideFacets beside_facets(const PanelMesh& mesh, const InsulatedBodies& bodies) {
  /// Largest sample.
  constexpr std::size_t most = 96;
  const std::size_t conductors = bodies.conductors.bodies.size();
  std::vector<std::size_t> panels, groups;
  std::vector<double> depths;
  std::vector<bool> are_added;
  for (std::size_t g = 0; g < mesh.groups().size(); ++g) {
    const PanelGroup& group = mesh.groups()[g];
    if (group.body < conductors || group.body >= conductors + bodies.insulators.size())
      continue;
    const std::optional<RoundShape>& round = bodies.insulators[group.body - conductors].round;
    for (std::size_t k = group.first; round && k < group.first + group.count; ++k)
      if (const double depth = round->depth(mesh.panels()[k].corners); depth > 0) {
        panels.push_back(k);
        groups.push_back(g);
        depths.push_back(depth);
        are_added.push_back(round->is_lack_added());
      }
  }
  BesideFacets result;
  const std::size_t count = std::min(most, panels.size());
  for (std::size_t k = 0; k < count; ++k) {
    const std::size_t at = k * panels.size() / count;
    const Panel& panel = mesh.panels()[panels[at]];
    result.panels.push_back(panels[at]);
    result.groups.push_back(groups[at]);
    result.depths.push_back(depths[at] * static_cast<double>(panels.size()) / static_cast<double>(count));
    result.are_added.push_back(are_added[at]);
    result.beside.push_back(shifted(panel, step_beside(panel) * unit_normal(panel.corners)));
  }
  return result;
}

FacetEffects facet_effects(const PanelMesh& mesh, const InsulatedBodies& bodies,
                           const InsulatedEquations& equations, const BesideFacets& facets,
                           const MatrixXd& values, double tolerance) {
  const InsulatedUnknowns& unknowns = equations.unknowns;
  const std::vector<Index> place = places_of_panels(mesh, unknowns);
  FacetEffects result{MatrixXd::Zero(values.cols(), values.cols()),
                      {},
                      {},
                      MatrixXd::Zero(index_of(mesh.groups().size()), values.cols())};
  std::vector<MatrixXd> roots;
  std::vector<std::size_t> groups;
  // Every panel has rows whether it is there or not: errors with and without some bodies are compared.
  const auto new_root = [&](std::size_t group) -> MatrixXd& {
    groups.push_back(group);
    return roots.emplace_back(MatrixXd::Zero(BesideFacets::rows, values.cols()));
  };
  for (std::size_t g = 0; g < mesh.groups().size(); ++g) {
    const PanelGroup& group = mesh.groups()[g];
    if (group.body >= bodies.conductors.bodies.size())
      continue;
    const RoundShape* const round = round_shape_of(bodies.conductors.bodies[group.body].surface);
    for (std::size_t panel = group.first; round != nullptr && panel < group.first + group.count; ++panel) {
      MatrixXd& root = new_root(g);
      const Index own = place[panel];
      if (own < 0 || unknowns.kind(own) != PartKind::conductor)
        continue;
      const Ratios& ratios = unknowns.states[static_cast<std::size_t>(own)].ratios;
      const double outside = round->is_thin() ? (ratios.behind + ratios.before) / 2 : ratios.before;
      const RowVectorXd charges = values.row(own);
      const double lack = round->lack_per_squared_charge(mesh.panels()[panel]) / outside;
      const double along_rim =
          round->lack_along_rim(mesh.panels()[panel], charges.cwiseAbs().maxCoeff() / outside) / outside;
      root.row(0) = std::sqrt(round->error_per_lack() * (lack + along_rim)) * charges;
      if (round->is_lack_added())
        result.added += lack * charges.transpose() * charges;
    }
  }
  std::vector<AngleTarget> targets;
  for (const std::size_t panel : facets.panels) {
    const Index own = place[panel];
    const double outside = own < 0 ? 1 : unknowns.states[static_cast<std::size_t>(own)].ratios.before;
    targets.push_back({outside, AngleSums::unknown});
  }
  const MatrixXd potentials = potentials_beside(mesh, bodies, equations, facets.beside, facets.double_layer,
                                                targets, values, tolerance);
  for (std::size_t k = 0; k < facets.panels.size(); ++k) {
    // Parts that lie on conductors, or are not there, are no unknowns.
    const Index own = place[facets.panels[k]];
    MatrixXd& root = new_root(facets.groups[k]);
    if (own < 0)
      continue;
    const Panel& panel = mesh.panels()[facets.panels[k]];
    const Ratios& ratios = unknowns.states[static_cast<std::size_t>(own)].ratios;
    RowVectorXd fall = values.row(own) - potentials.row(index_of(k));
    const bool is_known = fall.cwiseAbs().maxCoeff() <= most_fall;
    if (!is_known)
      fall = fall.cwiseMax(-1.0).cwiseMin(1.0);
    root << fall * std::sqrt(ratios.before / ratios.behind),
        falls_along(mesh, unknowns, place, mesh.groups()[facets.groups[k]], panel, values);
    root *= std::sqrt(std::abs(ratios.behind - ratios.before) / (4 * std::numbers::pi) * facets.depths[k] *
                      panel.area) /
            step_beside(panel);
    if (facets.are_added[k] && is_known)
      result.added += (ratios.behind > ratios.before ? 1 : -1) * root.transpose() * root;
    const bool is_followed = mesh.follows_shape(mesh.groups()[facets.groups[k]].body);
    root *= std::sqrt(facets.are_added[k] && is_known && is_followed ? error_per_followed_interface
                                                                     : error_per_facet_effect);
  }
  result.errors.resize(BesideFacets::rows * index_of(roots.size()), values.cols());
  result.lasting = MatrixXd::Zero(result.errors.rows(), values.cols());
  for (std::size_t k = 0; k < roots.size(); ++k) {
    const Index first = BesideFacets::rows * index_of(k);
    result.errors.middleRows(first, BesideFacets::rows) = roots[k];
    if (mesh.follows_shape(mesh.groups()[groups[k]].body))
      result.groups.row(index_of(groups[k])) += roots[k].colwise().squaredNorm();
    else
      result.lasting.middleRows(first, BesideFacets::rows) = roots[k];
  }
  return result;
}

}  // namespace fringe::detail
