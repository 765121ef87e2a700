#include "bem/insulated_system.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <span>
#include <utility>

#include <Eigen/Cholesky>
#include <fmt/format.h>

#include "bem/double_layer.hpp"
#include "bem/film_effects.hpp"
#include "bem/insulated_equations.hpp"
#include "bem/insulated_solutions.hpp"
#include "bem/proximity_refinement.hpp"
#include "fringe/error.hpp"
#include "numeric/cholesky.hpp"
#include "numeric/interruption.hpp"
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

/// Returns for every group of panels (rows) the energies of its own charges, those of each column. `charges`
/// are those of all panels.
MatrixXd energies_within_groups(const PanelMesh& mesh, const PanelOperator& single_layer,
                                const MatrixXd& charges) {
  MatrixXd result(index_of(mesh.groups().size()), charges.cols());
  for (std::size_t g = 0; g < mesh.groups().size(); ++g) {
    const PanelGroup& group = mesh.groups()[g];
    const auto own = charges.middleRows(index_of(group.first), index_of(group.count));
    result.row(index_of(g)) = own.cwiseProduct(single_layer.block_of_group(group) * own).colwise().sum();
  }
  return result;
}

/// Energies that the coarse space misses in the groups of panels (rows), for every column of the details and
/// of the charges that dielectric bodies miss which are almost conductors.
struct MissedEnergies {
  MatrixXd by_charges;
  MatrixXd by_potentials;  ///< of interfaces

  MatrixXd all() const { return by_charges + by_potentials; }
};

MissedEnergies missed_energies(const PanelMesh& mesh, const InsulatedUnknowns& unknowns,
                               const PanelOperator& single_layer, const MatrixXd& details,
                               const MatrixXd& almost_conductors) {
  const std::vector<Index> group_of = mesh.group_of_panels();
  MissedEnergies energies;
  energies.by_potentials = MatrixXd::Zero(index_of(mesh.groups().size()), details.cols());
  MatrixXd charges = MatrixXd::Zero(index_of(mesh.panels().size()), details.cols());
  for (Index k = 0; k < unknowns.size(); ++k) {
    const auto at = static_cast<std::size_t>(k);
    const Index panel = unknowns.panels[at];
    if (unknowns.is_charge(k)) {
      charges.row(panel) = details.row(k);
      continue;
    }
    const Ratios& ratios = unknowns.states[at].ratios;
    energies.by_potentials.row(group_of[static_cast<std::size_t>(panel)]) +=
        energy_of_potential_step * (ratios.behind + ratios.before) / 2 *
        std::sqrt(mesh.panels()[static_cast<std::size_t>(panel)].area) * details.row(k).cwiseAbs2();
  }
  energies.by_charges = energies_within_groups(mesh, single_layer, charges).cwiseAbs();
  energies.by_potentials += energies_within_groups(mesh, single_layer, almost_conductors).cwiseMax(0);
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
  return adjoint.transpose() * (equations.potentials - equations.matrix.times(found.coarse));
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
                                             const PanelOperator& single_layer, const MatrixXd& values,
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
    MatrixXd potentials = MatrixXd::Zero(values.rows(), values.cols());
    potentials(own, Eigen::all) = values(own, Eigen::all);
    const Cholesky factor(single_layer.block(panels), threads);
    // Where quadratures leave it indefinite, nothing is known; the panels are marked by their potentials.
    if (!factor.is_positive_definite())
      continue;
    potentials += equations.matrix.times(potentials);
    MatrixXd charges = factor.solve(potentials(own, Eigen::all));
    MatrixXd sums = MatrixXd::Zero(unknowns.coarse.size, values.cols());
    for (std::size_t k = 0; k < own.size(); ++k)
      sums.row(unknowns.coarse.place[static_cast<std::size_t>(own[k])]) += charges.row(index_of(k));
    for (std::size_t k = 0; k < own.size(); ++k)
      charges.row(index_of(k)) -=
          unknowns.coarse.shares[own[k]] * sums.row(unknowns.coarse.place[static_cast<std::size_t>(own[k])]);
    result(panels, Eigen::all) = charges;
  }
  return result;
}

/// Tells if the panels of conductors in each leaf have more energy, whatever their charges, than quadratures
/// of a tolerance may make up. Those that coincide or nearly do have not: in meshes of robots there are many.
bool are_regular(const PanelOperator& single_layer, const std::vector<bool>& is_charge, double tolerance) {
  const ClusterTree& tree = single_layer.tree();
  for (std::size_t leaf = 0; leaf < tree.leaves().size(); ++leaf) {
    const ClusterRange range = tree.clusters()[tree.leaves()[leaf]].panels;
    std::vector<Index> own;
    for (Index k = 0; k < range.count; ++k)
      if (is_charge[static_cast<std::size_t>(tree.panels()[static_cast<std::size_t>(range.first + k)])])
        own.push_back(k);
    if (own.empty())
      continue;
    const MatrixXd block = single_layer.matrix().diagonal_block(leaf)(own, own);
    const Eigen::LLT<MatrixXd> factor(block);
    if (factor.info() != Eigen::Success ||
        (factor.matrixLLT().diagonal().array().square() < tolerance * block.diagonal().array()).any())
      return false;
  }
  return true;
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

std::size_t InsulatedSystem::most_panels(double bytes) const {
  /// Memory of a pair of a panel and a source (its element, that before the last refinement and that of the
  /// equations), and of a panel for all else: of 20,815 of conductors alone, 22.6 kB were measured.
  constexpr double per_pair = 3 * sizeof(double), per_panel = 24e3;
  const std::vector<bool> is_source = have_flux();
  const double pairs = per_pair * static_cast<double>(std::count(is_source.begin(), is_source.end(), true)) /
                       static_cast<double>(panels());
  return static_cast<std::size_t>(2 * bytes /
                                  (per_panel + std::sqrt(per_panel * per_panel + 4 * pairs * bytes)));
}

void InsulatedSystem::raise_diagonal(double tolerance) {
  /// Least energy of charges on a panel beside others, relative to its own and to the tolerance, and the part
  /// by which the diagonal is raised where there is less, at most so often tenfold.
  constexpr double least_energy = 2, first_ridge = 10;
  constexpr int most_steps = 2;
  ridge_effects_ = VectorXd::Zero(index_of(panels()));
  std::vector<bool> is_charge;
  for (const PanelGroup& group : mesh_.groups())
    is_charge.insert(is_charge.end(), group.count, group.body < bodies_.conductors.bodies.size());
  double ridge = 0;
  for (int step = 0; step < most_steps && !are_regular(*single_layer_, is_charge, least_energy * tolerance);
       ++step) {
    const double next = ridge == 0 ? first_ridge * tolerance : 10 * ridge;
    single_layer_->scale_diagonal((1 + next) / (1 + ridge));
    ridge = next;
  }
  for (std::size_t k = 0; ridge > 0 && k < panels(); ++k)
    if (is_charge[k])
      ridge_effects_[index_of(k)] = ridge / (1 + ridge) * single_layer_->self(k);
}

void InsulatedSystem::evaluate(double tolerance) {
  // The first matrices have none before them, though the mesh may have been refined by proximity.
  const std::unique_ptr<PanelOperator> before = std::move(single_layer_);
  single_layer_ = std::make_unique<PanelOperator>(mesh_, tolerance, before.get(), threads_);
  raise_diagonal(tolerance);
  const std::vector<bool> is_source = have_flux();
  const DoubleLayer angles_before = std::move(double_layer_);
  double_layer_ = double_layer_of(
      mesh_.panels(), mesh_.panels(), is_source, tolerance,
      {angles_before, before ? std::span(mesh_.places_before()) : std::span<const Index>()}, threads_);
  const auto means_over = [&](std::span<const Panel> targets) {
    return double_layer_of(targets, mesh_.panels(), is_source, tolerance, {{}, {}}, threads_);
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
      insulated_equations(mesh_, bodies_, surroundings_[set], *single_layer_, double_layer_, threads_);
  const InsulatedUnknowns& unknowns = equations.unknowns;
  const InsulatedSolutions found = solved(unknowns, equations.matrix, equations.potentials, threads_);
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
      missed_charges_of_almost_conductors(mesh_, bodies_, equations, *single_layer_, found.fine, threads_);
  const MissedEnergies missed =
      missed_energies(mesh_, unknowns, *single_layer_, found.details, result.almost_conductors);
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
      missed_energies(mesh_, all.unknowns, *single_layer_, details(all.unknowns.panels, Eigen::all),
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
      insulated_equations(mesh_, bodies_, surroundings_.front(), *single_layer_, double_layer_, threads_);
  const InsulatedUnknowns& unknowns = equations.unknowns;
  const auto size = static_cast<std::size_t>(unknowns.size());
  MatrixXd right_sides(unknowns.size(), outer.cols());
  for (std::size_t k = 0; k < size; ++k)
    right_sides.row(index_of(k)) = -outer.row(unknowns.panels[k]);
  const InsulatedSolutions found = solved(unknowns, equations.matrix, right_sides, threads_);
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
  result.energies = largest_parts(missed_energies(mesh_, unknowns, *single_layer_, found.details,
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
