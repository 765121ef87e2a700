#include "bem/insulated_system.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <span>
#include <utility>

#include <fmt/format.h>

#include "bem/double_layer.hpp"
#include "bem/film_effects.hpp"
#include "bem/insulated_equations.hpp"
#include "bem/proximity_refinement.hpp"
#include "bem/single_layer_panels.hpp"
#include "fringe/error.hpp"
#include "numeric/cholesky.hpp"
#include "numeric/interruption.hpp"
#include "numeric/parallel.hpp"
#include "readings/maxwell_matrix.hpp"
#include "readings/readings.hpp"
#include "surface/hidden_surface.hpp"

namespace fringe::detail {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Part of the change from the coarse to the whole space by which values go on changing. Panels of half the
/// size halve the error of a charge that is singular at edges; 0.8 to 1.6 were measured at covers.
constexpr double still_missing = 1;

/// Ratio of the permittivities from which on a dielectric body is almost a conductor.
constexpr double almost_conductor = 20;

/// Part of the energy that potentials along films lose from triangles to their quarters, by which they go on
/// losing: panels of half the size quarter it.
constexpr double still_too_stiff = 1.0 / 3;

/// Makes a matrix symmetric of which the upper triangle is known.
void mirror_upper_triangle(MatrixXd& matrix, std::size_t threads) {
  /// Number of rows and columns of a tile: two of them fit in the nearest cache.
  constexpr Index together = 32;
  parallel_for(
      static_cast<std::size_t>((matrix.cols() + together - 1) / together), threads, [&](std::size_t k) {
        const Index first = index_of(k) * together, columns = std::min(together, matrix.cols() - first);
        auto own = matrix.block(first, first, columns, columns);
        own.triangularView<Eigen::StrictlyLower>() = own.transpose();
        for (Index row = first + columns; row < matrix.rows(); row += together) {
          const Index rows = std::min(together, matrix.rows() - row);
          matrix.block(row, first, rows, columns) = matrix.block(first, row, columns, rows).transpose();
        }
      });
}

/// Adds to the groups (rows) the energies of their own charges, for every column. `panels` are those of the
/// charges; those of a group are consecutive.
void add_energies_within_groups(const MatrixXd& single_layer, const std::vector<Index>& group_of,
                                const std::vector<Index>& panels, const MatrixXd& charges,
                                MatrixXd& energies) {
  const auto group = [&](Index k) {
    return group_of[static_cast<std::size_t>(panels[static_cast<std::size_t>(k)])];
  };
  for (Index k = 0; k < charges.rows(); ++k)
    for (Index l = k; l < charges.rows() && group(l) == group(k); ++l)
      energies.row(group(k)) +=
          ((l == k ? 1.0 : 2.0) *
           single_layer(panels[static_cast<std::size_t>(k)], panels[static_cast<std::size_t>(l)]) *
           charges.row(k).array() * charges.row(l).array())
              .matrix();
}

/// Energies that the coarse space misses in the groups of panels (rows), for every column of the details and
/// of the charges that dielectric bodies miss which are almost conductors.
struct MissedEnergies {
  MatrixXd by_charges;
  MatrixXd by_potentials;  ///< of interfaces

  MatrixXd all() const { return by_charges + by_potentials; }
};

MissedEnergies missed_energies(const PanelMesh& mesh, const InsulatedUnknowns& unknowns,
                               const MatrixXd& single_layer, const MatrixXd& details,
                               const MatrixXd& almost_conductors) {
  const std::vector<Index> group_of = mesh.group_of_panels();
  const MatrixXd none = MatrixXd::Zero(index_of(mesh.groups().size()), details.cols());
  MissedEnergies energies{none, none};
  std::vector<Index> charges, panels;
  for (Index k = 0; k < unknowns.size(); ++k) {
    const auto at = static_cast<std::size_t>(k);
    const Index panel = unknowns.panels[at];
    if (unknowns.is_charge(k)) {
      charges.push_back(k);
      panels.push_back(panel);
      continue;
    }
    const Ratios& ratios = unknowns.states[at].ratios;
    energies.by_potentials.row(group_of[static_cast<std::size_t>(panel)]) +=
        energy_of_potential_step * (ratios.behind + ratios.before) / 2 *
        std::sqrt(mesh.panels()[static_cast<std::size_t>(panel)].area) * details.row(k).cwiseAbs2();
  }
  add_energies_within_groups(single_layer, group_of, panels, details(charges, Eigen::all),
                             energies.by_charges);
  energies.by_charges = energies.by_charges.cwiseAbs();
  MatrixXd implied = none;
  std::vector<Index> all(mesh.panels().size());
  std::iota(all.begin(), all.end(), 0);
  add_energies_within_groups(single_layer, group_of, all, almost_conductors, implied);
  energies.by_potentials += implied.cwiseMax(0);
  return energies;
}

/// Returns the ratio of each change between the spaces to the energy that the coarse space misses with it. A
/// capacitance errs by far less than the energy of a potential's steps where panels resolve the potential. So
/// the energies tell which groups miss most, and the ratio how much all of them together matter.
VectorXd share_of_energies(const VectorXd& changes, const VectorXd& energies) {
  /// Least share: contributions may cancel in a change by chance. Largest one: potentials of bodies that are
  /// almost conductors hardly vary.
  constexpr double least = 3e-3, largest = 10;
  VectorXd result(changes.size());
  for (Index k = 0; k < changes.size(); ++k)
    result[k] = energies[k] > 0 ? std::clamp(std::abs(changes[k]) / energies[k], least, largest) : 1;
  return result;
}

/// Returns what the conductors' charges of the whole space add to the capacitances of the coarse one. These
/// differ by the residuals of the coarse solution times the solution of the adjoint equations, which is, on
/// conductors, the charge over the permittivity there.
MatrixXd gains_by_charges(const InsulatedEquations& equations, const InsulatedSolutions& found) {
  const InsulatedUnknowns& unknowns = equations.unknowns;
  MatrixXd adjoint = MatrixXd::Zero(unknowns.size(), found.fine.cols());
  for (Index k = 0; k < unknowns.size(); ++k)
    if (unknowns.is_charge(k)) {
      const Ratios& ratios = unknowns.states[static_cast<std::size_t>(k)].ratios;
      adjoint.row(k) = 2 / (ratios.behind + ratios.before) * found.fine.row(k);
    }
  return adjoint.transpose() * (equations.potentials - equations.matrix * found.coarse);
}

/// Adds the flux that enters films from conductors to the free charges of these.
void add_flux_into_films(const ChargedBodies& bodies, const InsulatedEquations& equations,
                         const InsulatedSolutions& found, InsulatedSolution& result) {
  const MatrixXd &lifts = equations.films->lifts(), &direct = equations.films->direct();
  const auto conductor_of = [&](Index body) {
    return index_of(bodies.bodies[static_cast<std::size_t>(body)].conductor);
  };
  for (Index body = 0; body < lifts.cols(); ++body) {
    Eigen::RowVectorXd fine = Eigen::RowVectorXd::Zero(found.fine.cols());
    for (Index other = 0; other < lifts.cols(); ++other)
      fine[conductor_of(other)] += direct(body, other);
    Eigen::RowVectorXd coarse = fine;
    for (std::size_t k = 0; k < equations.film_unknowns.size(); ++k) {
      const Index unknown = equations.film_unknowns[k];
      const double lift = lifts(index_of(k), body);
      fine += lift * found.fine.row(unknown);
      coarse += lift * found.coarse.row(unknown);
    }
    result.matrix.fine.row(conductor_of(body)) += fine;
    result.matrix.coarse.row(conductor_of(body)) += coarse;
    result.body_charges.row(body) += fine;
  }
}

/// Returns the charges on the panels (rows) of dielectric bodies that are almost conductors which the coarse
/// space misses, for every column of a solution. Their potential hardly varies, whatever the panels. So their
/// errors are those of the charges that would bring the potential of everything else there to their own.
MatrixXd missed_charges_of_almost_conductors(const PanelMesh& mesh, const InsulatedBodies& bodies,
                                             const InsulatedEquations& equations,
                                             const MatrixXd& single_layer, const MatrixXd& values,
                                             std::size_t threads) {
  const InsulatedUnknowns& unknowns = equations.unknowns;
  MatrixXd result = MatrixXd::Zero(index_of(mesh.panels().size()), values.cols());
  for (std::size_t body = 0; body < bodies.insulators.size(); ++body) {
    if (bodies.insulators[body].ratio < almost_conductor)
      continue;
    std::vector<Index> own, panels;
    for (Index k = 0; k < unknowns.size(); ++k)
      if (!unknowns.is_charge(k) &&
          unknowns.body[static_cast<std::size_t>(k)] == index_of(body + bodies.conductors.bodies.size())) {
        own.push_back(k);
        panels.push_back(unknowns.panels[static_cast<std::size_t>(k)]);
      }
    if (own.empty())
      continue;
    check_interruption();
    const MatrixXd potentials = values(own, Eigen::all);
    const Cholesky factor(single_layer(panels, panels), threads);
    // Where quadratures leave it indefinite, nothing is known; the panels are marked by their potentials.
    if (!factor.is_positive_definite())
      continue;
    MatrixXd charges = factor.solve(potentials + equations.matrix(own, own) * potentials);
    MatrixXd sums = MatrixXd::Zero(unknowns.coarse_size, values.cols());
    for (std::size_t k = 0; k < own.size(); ++k)
      sums.row(unknowns.coarse[static_cast<std::size_t>(own[k])]) += charges.row(index_of(k));
    for (std::size_t k = 0; k < own.size(); ++k)
      charges.row(index_of(k)) -=
          unknowns.shares[own[k]] * sums.row(unknowns.coarse[static_cast<std::size_t>(own[k])]);
    result(panels, Eigen::all) = charges;
  }
  return result;
}

}  // namespace

MatrixXd symmetric(const MatrixXd& matrix) {
  return (matrix + matrix.transpose()) / 2;
}

InsulatedSystem::InsulatedSystem(const InsulatedBodies& bodies, const std::vector<Presence>& others,
                                 const PanelGrading& grading, std::size_t threads)
    : bodies_(bodies), surroundings_{{bodies, everything(bodies)}}, threads_(threads) {
  for (const Presence& other : others)
    surroundings_.emplace_back(bodies, other);
  const HiddenSurface hidden(bodies.conductors);
  const std::size_t conductors = bodies.conductors.bodies.size();
  std::vector<std::vector<Triangle>> surfaces = divided_surfaces(bodies);
  PanelGrading of_body = grading;
  of_body.most_panels /= std::max<std::size_t>(surfaces.size(), 1);
  // A panel that follows a shape leaves a crack beside a neighbour that is not divided with it. The crack
  // charges a dielectric body, the more the higher its permittivity is.
  const auto followed_by = [&](std::size_t body) -> const RoundShape* {
    if (!surroundings_.front().is_apart(body))
      return nullptr;
    if (body < conductors)
      return round_shape_of(bodies.conductors.bodies[body].surface);
    if (body >= conductors + bodies.insulators.size())
      return nullptr;
    const Insulator& insulator = bodies.insulators[body - conductors];
    return follows_shape(insulator) && surfaces[body].size() <= PanelMesh::few_triangles ? &*insulator.round
                                                                                         : nullptr;
  };
  for (std::size_t body = 0; body < surfaces.size(); ++body) {
    std::erase_if(surfaces[body], [&](const Triangle& part) {
      return (body < conductors && hidden.contains(part, body)) ||
             std::all_of(surroundings_.begin(), surroundings_.end(), [&](const Surroundings& set) {
               return set.state(part, body).kind == PartKind::absent;
             });
    });
    if (body >= conductors && surfaces[body].empty() &&
        surroundings_.front().is_inside_conductor(body - conductors))
      throw InputError(fmt::format("{} is dielectric and wholly inside a conductor, where there is no field",
                                   bodies.insulators[body - conductors].name));
    if (surfaces[body].empty())
      continue;
    const RoundShape* const followed = followed_by(body);
    const bool is_closed = followed != nullptr && body >= conductors;
    mesh_.add(body, surfaces[body], is_closed ? PanelGrading{} : of_body, followed);
    if (is_closed)
      mesh_.keep_closed(body);
  }
  ChargedBodies all = bodies.conductors;
  for (const Insulator& insulator : bodies.insulators)
    all.bodies.push_back(surface_of(insulator));
  refine_by_proximity(mesh_, all, grading.most_panels);
}

double InsulatedSystem::undivided_error() const {
  const std::size_t conductors = bodies_.conductors.bodies.size();
  std::map<std::size_t, std::size_t> triangles;
  std::map<std::size_t, bool> are_undivided;
  for (const PanelGroup& group : mesh_.groups()) {
    if (group.body < conductors || group.body >= conductors + bodies_.insulators.size() ||
        bodies_.insulators[group.body - conductors].ratio < almost_conductor)
      continue;
    triangles[group.body] += group.count;
    are_undivided[group.body] = are_undivided[group.body] || !group.is_quartered;
  }
  double result = 0;
  for (const auto& [body, count] : triangles)
    if (are_undivided[body])
      result = std::max(result, 1 / static_cast<double>(count));
  return result;
}

std::vector<bool> InsulatedSystem::have_flux() const {
  std::vector<bool> result(panels(), false);
  for (const PanelGroup& group : mesh_.groups())
    for (std::size_t k = group.first; k < group.first + group.count; ++k)
      result[k] = std::any_of(surroundings_.begin(), surroundings_.end(), [&](const Surroundings& set) {
        const PartState state = set.state(mesh_.panels()[k].corners, group.body);
        // The effect of a film's thickness depends on the flux through it.
        return state.kind == PartKind::film ||
               (state.kind != PartKind::absent && state.ratios.behind != state.ratios.before) ||
               (state.kind == PartKind::conductor && set.film_on(mesh_.panels()[k].corners));
      });
  return result;
}

void InsulatedSystem::evaluate(double tolerance) {
  const MatrixXd single = std::move(single_layer_), twofold = std::move(double_layer_);
  // The first matrices have none before them, though the mesh may have been refined by proximity.
  const std::span<const Index> places =
      single.size() == 0 ? std::span<const Index>() : std::span(mesh_.places_before());
  single_layer_ = single_layer_matrix(mesh_.panels(), tolerance, {single, places}, threads_);
  mirror_upper_triangle(single_layer_, threads_);
  const std::vector<bool> is_source = have_flux();
  double_layer_ =
      double_layer_matrix(mesh_.panels(), mesh_.panels(), is_source, tolerance, {twofold, places}, threads_);
  const auto means_over = [&](std::span<const Panel> targets) {
    return double_layer_matrix(targets, mesh_.panels(), is_source, tolerance, {MatrixXd(), {}}, threads_);
  };
  quarters_.sampled = sampled_quarters(mesh_);
  quarters_.double_layer = means_over(quarters_.sampled.panels);
  facets_ = beside_facets(mesh_, bodies_);
  facets_.double_layer = means_over(facets_.beside);
  tolerance_ = tolerance;
}

InsulatedSolution InsulatedSystem::solve(std::size_t set) const {
  const ChargedBodies& bodies = bodies_.conductors;
  const InsulatedEquations equations =
      insulated_equations(mesh_, bodies_, surroundings_[set], single_layer_, double_layer_, threads_);
  const InsulatedUnknowns& unknowns = equations.unknowns;
  const InsulatedSolutions found = solved(mesh_, equations, equations.potentials, threads_);
  const Index conductors = index_of(bodies.conductors.size());
  InsulatedSolution result;
  result.matrix = {MatrixXd::Zero(conductors, conductors), MatrixXd::Zero(conductors, conductors)};
  result.panels = result.details = MatrixXd::Zero(index_of(panels()), conductors);
  result.body_charges = MatrixXd::Zero(index_of(bodies.bodies.size()), conductors);
  for (Index k = 0; k < unknowns.size(); ++k) {
    const auto at = static_cast<std::size_t>(k);
    result.panels.row(unknowns.panels[at]) = found.fine.row(k);
    result.details.row(unknowns.panels[at]) = found.details.row(k);
    if (unknowns.kind(k) != PartKind::conductor)
      continue;
    const Index conductor = index_of(bodies.bodies[static_cast<std::size_t>(unknowns.body[at])].conductor);
    result.matrix.fine.row(conductor) += found.fine.row(k);
    result.matrix.coarse.row(conductor) += found.coarse.row(k);
    result.body_charges.row(unknowns.body[at]) += found.fine.row(k);
  }
  if (equations.films)
    add_flux_into_films(bodies, equations, found, result);
  result.half_refined = result.matrix.coarse + gains_by_charges(equations, found);
  result.almost_conductors =
      missed_charges_of_almost_conductors(mesh_, bodies_, equations, single_layer_, found.fine, threads_);
  const MissedEnergies missed =
      missed_energies(mesh_, unknowns, single_layer_, found.details, result.almost_conductors);
  const FilmEffects films =
      film_effects(mesh_, bodies_, surroundings_[set], equations, double_layer_, found.fine);
  for (const auto& [panel, side] : films.bent) {
    // The mesh halves the side along which the quarters at its ends differ most.
    const auto first = index_of(panel);
    const double size = result.panels.middleRows(first, 4).cwiseAbs().maxCoeff();
    result.panels.middleRows(first, 4).setZero();
    result.panels(first + index_of(side), 0) = size;
    result.panels(first + index_of((side + 1) % 3), 0) = -size;
  }
  result.extrapolated = result.matrix.fine + still_missing * (result.matrix.fine - result.matrix.coarse) +
                        films.across - films.crowding - still_too_stiff * films.energies;
  result.film_effects = films.across + films.crowding;
  result.missed_energies = (missed.all() + films.group_energies).colwise().sum();
  UndividedGain undivided = undivided_gain(mesh_, bodies_, equations, quarters_, found.fine, tolerance_);
  result.undivided = std::move(undivided.roots);
  FacetEffects facets = facet_effects(mesh_, bodies_, equations, facets_, found.fine, tolerance_);
  result.extrapolated += facets.added;
  result.facets = std::move(facets.errors);
  result.lasting_facets = std::move(facets.lasting);
  const auto weighted = [&](const MatrixXd& energies, const MatrixXd& change) {
    const VectorXd shares = share_of_energies(change.diagonal(), energies.colwise().sum());
    return MatrixXd(energies * shares.asDiagonal());
  };
  result.error_indicators =
      largest_parts(weighted(missed.by_charges, result.half_refined - result.matrix.coarse) +
                        weighted(missed.by_potentials, result.matrix.fine - result.half_refined) +
                        films.group_energies + undivided.groups + facets.groups,
                    result.matrix.fine.diagonal());
  result.unknowns = unknowns;
  return result;
}

VectorXd InsulatedSystem::change_indicators(const InsulatedSolution& all, const InsulatedSolution& background,
                                            const StepsOfChanges& steps) const {
  const ChargedBodies& bodies = bodies_.conductors;
  const NestedMatrix with{symmetric(all.matrix.fine), symmetric(all.matrix.coarse)},
      without{symmetric(background.matrix.fine), symmetric(background.matrix.coarse)};
  const auto of_readings = [&](const MatrixXd& charges, const MatrixXd& charges_alone) {
    return reading_charges(charges, with.fine, charges_alone, without.fine, bodies).all();
  };
  const MatrixXd details = of_readings(all.details, background.details);
  const MissedEnergies missed =
      missed_energies(mesh_, all.unknowns, single_layer_, details(all.unknowns.panels, Eigen::all),
                      of_readings(all.almost_conductors, background.almost_conductors));
  const VectorXd scales = change_scales(with, without, bodies);
  const auto weighted = [&](const MatrixXd& energies, const VectorXd& changes) {
    const VectorXd sums = reading_effects(energies_of_pairs(energies)).change;
    return largest_parts_of_change(energies, scales.cwiseQuotient(share_of_energies(changes, sums)));
  };
  return weighted(missed.by_charges, steps.by_charges) + weighted(missed.by_potentials, steps.by_potentials);
}

InsulatedResponse InsulatedSystem::respond(const MatrixXd& outer, const VectorXd& own) const {
  const InsulatedEquations equations =
      insulated_equations(mesh_, bodies_, surroundings_.front(), single_layer_, double_layer_, threads_);
  const InsulatedUnknowns& unknowns = equations.unknowns;
  const auto size = static_cast<std::size_t>(unknowns.size());
  MatrixXd right_sides(unknowns.size(), outer.cols());
  for (std::size_t k = 0; k < size; ++k)
    right_sides.row(index_of(k)) = -outer.row(unknowns.panels[k]);
  const InsulatedSolutions found = solved(mesh_, equations, right_sides, threads_);
  InsulatedResponse result;
  result.potentials = result.coarse_potentials = result.charges =
      MatrixXd::Zero(index_of(panels()), outer.cols());
  for (std::size_t k = 0; k < size; ++k) {
    const Index panel = unknowns.panels[k];
    if (unknowns.is_charge(index_of(k))) {
      result.charges.row(panel) = found.fine.row(index_of(k));
      continue;
    }
    result.potentials.row(panel) = found.fine.row(index_of(k));
    result.coarse_potentials.row(panel) = found.coarse.row(index_of(k));
  }
  result.energies = largest_parts(missed_energies(mesh_, unknowns, single_layer_, found.details,
                                                  MatrixXd::Zero(index_of(panels()), outer.cols()))
                                      .all(),
                                  own);
  return result;
}

std::vector<Index> InsulatedSystem::outermost_panels() const {
  std::vector<Index> result;
  for (std::size_t k = 0; k < panels(); ++k)
    if (surroundings_.front().is_outermost(mesh_.panels()[k].corners))
      result.push_back(index_of(k));
  return result;
}

void InsulatedSystem::refine(const std::vector<int>& marked, const MatrixXd& panels) {
  mesh_.refine(marked, panels);
}

}  // namespace fringe::detail
