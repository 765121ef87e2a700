#include "bem/insulated_system.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <optional>
#include <span>
#include <utility>

#include <Eigen/LU>
#include <fmt/format.h>

#include "bem/double_layer.hpp"
#include "bem/film_sheets.hpp"
#include "bem/hidden_surface.hpp"
#include "bem/proximity_refinement.hpp"
#include "bem/single_layer_panels.hpp"
#include "fringe/error.hpp"
#include "geometry/median_split.hpp"
#include "numeric/gmres.hpp"
#include "numeric/interruption.hpp"

namespace fringe::detail {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Part of the change from the coarse to the whole space by which values go on changing. Panels of half the
/// size halve the error of a charge that is singular at edges; 0.8 to 1.6 were measured at covers.
constexpr double still_missing = 1;

/// Part of the energy that potentials along films lose from triangles to their quarters, by which they go on
/// losing: panels of half the size quarter it.
constexpr double still_too_stiff = 1.0 / 3;

/// The unknowns of a set of bodies: one for each panel that is there, and for the coarse space one for those
/// of a group that are alike.
struct Unknowns {
  std::vector<Index> panels;      ///< of each unknown
  std::vector<PartState> states;  ///< of each unknown
  std::vector<Index> coarse;      ///< of each unknown, its place in the coarse space
  std::vector<Index> body;        ///< of each unknown
  VectorXd shares;                ///< of each unknown, its part of the area of its place in the coarse space
  Index coarse_size = 0;

  Index size() const { return index_of(panels.size()); }
  PartKind kind(Index k) const { return states[static_cast<std::size_t>(k)].kind; }
  /// Tells if the unknown is a charge; else it is the potential of an interface.
  bool is_charge(Index k) const { return kind(k) != PartKind::interface; }
};

Unknowns unknowns_of(const PanelMesh& mesh, const Surroundings& surroundings) {
  Unknowns result;
  std::vector<double> areas, whole;
  for (const PanelGroup& group : mesh.groups()) {
    check_interruption();
    std::vector<std::pair<PartState, Index>> places;
    for (std::size_t panel = group.first; panel < group.first + group.count; ++panel) {
      const PartState state = surroundings.state(mesh.panels()[panel].corners, group.body);
      if (state.kind == PartKind::absent)
        continue;
      auto place =
          std::find_if(places.begin(), places.end(), [&](const auto& known) { return known.first == state; });
      if (place == places.end()) {
        place = places.insert(places.end(), {state, result.coarse_size++});
        whole.push_back(0);
      }
      result.panels.push_back(index_of(panel));
      result.states.push_back(state);
      result.coarse.push_back(place->second);
      result.body.push_back(index_of(group.body));
      areas.push_back(mesh.panels()[panel].area);
      whole[static_cast<std::size_t>(place->second)] += areas.back();
    }
  }
  result.shares.resize(result.size());
  for (Index k = 0; k < result.size(); ++k) {
    const auto at = static_cast<std::size_t>(k);
    result.shares[k] = areas[at] / whole[static_cast<std::size_t>(result.coarse[at])];
  }
  return result;
}

/// Returns the sums of weighted rows that have the same place in the coarse space.
MatrixXd summed_rows(const Unknowns& unknowns, const MatrixXd& rows, bool are_weighted) {
  MatrixXd result = MatrixXd::Zero(unknowns.coarse_size, rows.cols());
  for (Index column = 0; column < rows.cols(); ++column)
    for (Index k = 0; k < rows.rows(); ++k)
      result(unknowns.coarse[static_cast<std::size_t>(k)], column) +=
          (are_weighted ? unknowns.shares[k] : 1.0) * rows(k, column);
  return result;
}

/// The equations in the coarse space: one density, or one potential, on panels that are alike.
class CoarseCorrection {
 public:
  CoarseCorrection(const Unknowns& unknowns, const MatrixXd& matrix) : unknowns_(unknowns) {
    MatrixXd half = summed_rows(unknowns, matrix, true).transpose();
    for (Index k = 0; k < unknowns.size(); ++k)
      if (unknowns.is_charge(k))
        half.row(k) *= unknowns.shares[k];
    factor_.compute(summed_rows(unknowns, half, false).transpose());
  }

  /// Solves for the densities and potentials of the coarse space.
  MatrixXd solve(const MatrixXd& potentials) const {
    return factor_.solve(summed_rows(unknowns_, potentials, true));
  }

  /// Returns what each panel has of a solution of the coarse space.
  MatrixXd on_panels(const MatrixXd& solution) const {
    MatrixXd result(unknowns_.size(), solution.cols());
    for (Index k = 0; k < unknowns_.size(); ++k)
      result.row(k) = (unknowns_.is_charge(k) ? unknowns_.shares[k] : 1.0) *
                      solution.row(unknowns_.coarse[static_cast<std::size_t>(k)]);
    return result;
  }

 private:
  const Unknowns& unknowns_;
  Eigen::PartialPivLU<MatrixXd> factor_;
};

/// The inverses of the blocks of panels that are close to each other.
class NearbyPanels {
 public:
  NearbyPanels(const PanelMesh& mesh, const Unknowns& unknowns, const MatrixXd& matrix) {
    std::vector<Index> order(unknowns.panels.size());
    for (std::size_t k = 0; k < order.size(); ++k)
      order[k] = index_of(k);
    divide(order, [&](Index k) -> const Eigen::Vector3d& {
      return mesh.panels()[static_cast<std::size_t>(unknowns.panels[static_cast<std::size_t>(k)])].centre;
    });
    for (const std::vector<Index>& block : blocks_)
      factors_.emplace_back(MatrixXd(matrix(block, block)));
  }

  MatrixXd solve(const MatrixXd& potentials) const {
    MatrixXd result(potentials.rows(), potentials.cols());
    for (std::size_t k = 0; k < blocks_.size(); ++k) {
      // Eigen's solver cannot work in selected rows.
      const MatrixXd own = potentials(blocks_[k], Eigen::all);
      const MatrixXd solution = factors_[k].solve(own);
      result(blocks_[k], Eigen::all) = solution;
    }
    return result;
  }

 private:
  template <class CentreOf>
  void divide(std::span<Index> part, const CentreOf& centre_of) {
    /// Largest number of panels in a block.
    constexpr std::size_t most = 96;
    if (part.size() <= most) {
      blocks_.emplace_back(part.begin(), part.end());
      return;
    }
    const std::size_t half = part.size() / 2;
    split_at_median(part, half, centre_of);
    divide(part.first(half), centre_of);
    divide(part.subspan(half), centre_of);
  }

  std::vector<std::vector<Index>> blocks_;
  std::vector<Eigen::PartialPivLU<MatrixXd>> factors_;
};

/// Solves the equations of all panels: by factorisation if there are few, else by generalised minimal
/// residuals with the coarse space and the blocks of nearby panels as preconditioner.
MatrixXd solve_all(const PanelMesh& mesh, const Unknowns& unknowns, const MatrixXd& matrix,
                   const CoarseCorrection& coarse, const MatrixXd& right_sides) {
  /// Least number of unknowns for each right side, and altogether, with which the iteration takes less time.
  constexpr Index least_per_column = 60, least_unknowns = 1200;
  /// Largest residual, relative to the right side: far below the accuracy that can be asked for.
  constexpr double residual = 1e-7;
  constexpr int most_steps = 150;
  if (unknowns.size() >= std::max(least_unknowns, least_per_column * right_sides.cols())) {
    const NearbyPanels nearby(mesh, unknowns, matrix);
    const auto solution = gmres(
        [&](const MatrixXd& columns) {
          check_interruption();
          return MatrixXd(matrix * columns);
        },
        [&](const MatrixXd& columns) {
          const MatrixXd first = coarse.on_panels(coarse.solve(columns));
          return MatrixXd(first + nearby.solve(columns - matrix * first));
        },
        right_sides, residual, most_steps);
    if (solution)
      return *solution;
  }
  return matrix.partialPivLu().solve(right_sides);
}

}  // namespace

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
    if (!surfaces[body].empty())
      mesh_.add(body, surfaces[body], of_body);
  }
  ChargedBodies all = bodies.conductors;
  for (const Insulator& insulator : bodies.insulators)
    all.bodies.push_back(surface_of(insulator));
  const std::vector<InducedCharge> induced = induced_charges(all);
  const auto is_too_large = [&](const PanelGroup& group) {
    const std::vector<Triangle> triangles = mesh_.triangles(group);
    for (std::size_t body = 0; body < induced.size(); ++body)
      if (body != group.body)
        for (const Triangle& triangle : triangles)
          if (induced[body].is_narrow_on(triangle))
            return true;
    return false;
  };
  while (mesh_.panels().size() < grading.most_panels) {
    std::vector<bool> marked;
    for (const PanelGroup& group : mesh_.groups()) {
      check_interruption();
      marked.push_back(is_too_large(group));
    }
    if (std::find(marked.begin(), marked.end(), true) == marked.end())
      break;
    // With equal charges, triangles are halved across their longest sides.
    mesh_.refine(marked, MatrixXd::Ones(index_of(mesh_.panels().size()), 1));
  }
}

double InsulatedSystem::undivided_error() const {
  std::map<std::size_t, std::size_t> triangles;
  std::map<std::size_t, bool> are_undivided;
  for (const PanelGroup& group : mesh_.groups()) {
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
        // Of films, the flux through them is asked for.
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
  single_layer_ = single_layer_matrix(mesh_.panels(), tolerance, {single, places});
  single_layer_.triangularView<Eigen::StrictlyLower>() =
      single_layer_.transpose().triangularView<Eigen::StrictlyLower>();
  double_layer_ = double_layer_matrix(mesh_.panels(), have_flux(), tolerance, {twofold, places}, threads_);
}

namespace {

/// The equations of a set of bodies: every row is the mean over a panel of
/// ε(x)·u(x) = Σ V q + Σ (ε behind − ε before)·u·(solid angle/4π).
struct Equations {
  Unknowns unknowns;
  MatrixXd matrix;
  MatrixXd potentials;  ///< right sides, one column for every conductor at unit potential
  std::optional<FilmSheets> films;
  std::vector<Index> film_unknowns;  ///< places of the films' panels among the unknowns
};

/// Solutions in the whole space and in the coarse one, and what the coarse space misses.
struct Solutions {
  MatrixXd fine;
  MatrixXd coarse;
  MatrixXd details;
};

Solutions solutions_of(const PanelMesh& mesh, const Equations& equations, const MatrixXd& right_sides) {
  const Unknowns& unknowns = equations.unknowns;
  const CoarseCorrection coarse(unknowns, equations.matrix);
  Solutions result;
  result.fine = solve_all(mesh, unknowns, equations.matrix, coarse, right_sides);
  result.coarse = coarse.solve(right_sides);
  result.details = result.fine;
  const MatrixXd means = summed_rows(unknowns, result.fine, false),
                 weighted = summed_rows(unknowns, result.fine, true);
  for (Index k = 0; k < unknowns.size(); ++k) {
    const auto place = unknowns.coarse[static_cast<std::size_t>(k)];
    if (unknowns.is_charge(k))
      result.details.row(k) -= unknowns.shares[k] * means.row(place);
    else
      result.details.row(k) -= weighted.row(place);
  }
  return result;
}

/// Returns the films of a set of bodies, and adds them to the equations.
void add_films(const PanelMesh& mesh, const InsulatedBodies& bodies, const Surroundings& surroundings,
               Equations& equations) {
  const Unknowns& unknowns = equations.unknowns;
  const std::size_t conductors = bodies.conductors.bodies.size();
  std::vector<SheetPanel> panels;
  Eigen::AlignedBox3d box;
  for (Index k = 0; k < unknowns.size(); ++k) {
    if (unknowns.kind(k) != PartKind::film)
      continue;
    const auto at = static_cast<std::size_t>(k);
    const ThinFilm& film =
        bodies.films[static_cast<std::size_t>(unknowns.body[at]) - conductors - bodies.insulators.size()];
    panels.push_back({mesh.panels()[static_cast<std::size_t>(unknowns.panels[at])].corners,
                      film.thickness * (film.ratio - 1), film.thickness});
    equations.film_unknowns.push_back(k);
    box.extend(film.box);
  }
  if (panels.empty())
    return;
  equations.films.emplace(
      std::move(panels),
      [&](const Eigen::Vector3d& corner) { return surroundings.conductor_at(corner, box); }, conductors);
  const std::vector<Index>& own = equations.film_unknowns;
  equations.matrix(own, own) += equations.films->compliance();
  for (std::size_t body = 0; body < conductors; ++body)
    equations.potentials(own, index_of(bodies.conductors.bodies[body].conductor)) +=
        equations.films->lifts().col(index_of(body));
}

Equations equations_of(const PanelMesh& mesh, const InsulatedBodies& bodies, const Surroundings& surroundings,
                       const MatrixXd& single_layer, const MatrixXd& double_layer) {
  Equations result;
  result.unknowns = unknowns_of(mesh, surroundings);
  const Unknowns& unknowns = result.unknowns;
  const Index size = unknowns.size();
  const auto conductor_of = [&](Index k) {
    const Index body = unknowns.body[static_cast<std::size_t>(k)];
    return index_of(bodies.conductors.bodies[static_cast<std::size_t>(body)].conductor);
  };
  result.matrix.resize(size, size);
  result.potentials = MatrixXd::Zero(size, index_of(bodies.conductors.conductors.size()));
  for (Index column = 0; column < size; ++column) {
    const auto at = static_cast<std::size_t>(column);
    const Ratios& ratios = unknowns.states[at].ratios;
    const double jump = ratios.behind - ratios.before, mean = (ratios.behind + ratios.before) / 2;
    const Index source = unknowns.panels[at];
    VectorXd layer;
    if (jump != 0) {
      layer.resize(size);
      for (Index row = 0; row < size; ++row)
        layer[row] = jump * double_layer(unknowns.panels[static_cast<std::size_t>(row)], source);
      layer[column] -= mean;
    }
    if (!unknowns.is_charge(column)) {
      result.matrix.col(column) = layer;
      continue;
    }
    for (Index row = 0; row < size; ++row)
      result.matrix(row, column) = single_layer(unknowns.panels[static_cast<std::size_t>(row)], source);
    if (unknowns.kind(column) == PartKind::film)
      continue;
    if (jump != 0)
      result.potentials.col(conductor_of(column)) -= layer;
    else
      result.potentials(column, conductor_of(column)) += mean;
  }
  if (!bodies.films.empty())
    add_films(mesh, bodies, surroundings, result);
  return result;
}

/// Returns the group of every panel.
std::vector<Index> group_of_panels(const PanelMesh& mesh) {
  std::vector<Index> result(mesh.panels().size());
  for (std::size_t g = 0; g < mesh.groups().size(); ++g)
    for (std::size_t k = 0; k < mesh.groups()[g].count; ++k)
      result[mesh.groups()[g].first + k] = index_of(g);
  return result;
}

/// What the sheets of films lack, between conductors at unit potential.
struct FilmEffects {
  MatrixXd group_energies;  ///< of the potential along films beyond that of undivided panels (rows: groups)
  std::vector<std::pair<std::size_t, std::size_t>> bent;  ///< undivided panels, by the first quarter, and
                                                          ///< the side along which the potential is bent most
  MatrixXd energies;                                      ///< their sums, between all columns
  MatrixXd across;                                        ///< what the films' thickness adds
  MatrixXd crowding;  ///< what it takes away beside the borders of conductors
};

FilmEffects film_effects(const PanelMesh& mesh, const InsulatedBodies& bodies,
                         const Surroundings& surroundings, const Equations& equations,
                         const MatrixXd& double_layer, const MatrixXd& charges) {
  const Index count = charges.cols();
  const MatrixXd none = MatrixXd::Zero(count, count);
  FilmEffects result{MatrixXd::Zero(index_of(mesh.groups().size()), count), {}, none, none, none};
  if (!equations.films)
    return result;
  const Unknowns& unknowns = equations.unknowns;
  const FilmSheets& films = *equations.films;
  const std::vector<Index>& own = equations.film_unknowns;
  const std::size_t conductors = bodies.conductors.bodies.size();
  MatrixXd at_unit = MatrixXd::Zero(index_of(conductors), count);
  for (std::size_t body = 0; body < conductors; ++body)
    at_unit(index_of(body), index_of(bodies.conductors.bodies[body].conductor)) = 1;
  const MatrixXd corners = films.corner_potentials(charges(own, Eigen::all), at_unit);
  const std::vector<Index> group_of = group_of_panels(mesh);
  for (std::size_t k = 0; k < own.size(); ++k) {
    result.crowding += films.crowding(k, corners.middleRows(3 * index_of(k), 3));
    const auto panel = static_cast<std::size_t>(unknowns.panels[static_cast<std::size_t>(own[k])]);
    const Index group = group_of[panel];
    const PanelGroup& panels = mesh.groups()[static_cast<std::size_t>(group)];
    if (panel != panels.first || !panels.is_quartered || k + 4 > own.size() ||
        unknowns.panels[static_cast<std::size_t>(own[k + 3])] != index_of(panel + 3))
      continue;
    // The first three quarters are those at the corners, in their order; so are their corners.
    MatrixXd whole(3, count);
    for (Index corner = 0; corner < 3; ++corner)
      whole.row(corner) = corners.row(3 * (index_of(k) + corner) + corner);
    const Triangle triangle = mesh.triangles(panels).front();
    const Eigen::Vector3d second = triangle[1] - triangle[0], third = triangle[2] - triangle[0];
    Eigen::Matrix<double, 3, 2> sides;
    sides << second, third;
    const Eigen::Matrix<double, 2, 3> inverse = (sides.transpose() * sides).inverse() * sides.transpose();
    // The middles of the sides are corners of the first and second quarter.
    const std::array<VectorXd, 3> bends{corners.row(3 * index_of(k) + 1) - (whole.row(0) + whole.row(1)) / 2,
                                        corners.row(3 * index_of(k) + 5) - (whole.row(1) + whole.row(2)) / 2,
                                        corners.row(3 * index_of(k) + 2) - (whole.row(2) + whole.row(0)) / 2};
    const auto most = std::distance(
        bends.begin(), std::max_element(bends.begin(), bends.end(), [](const auto& a, const auto& b) {
          return a.squaredNorm() < b.squaredNorm();
        }));
    result.bent.emplace_back(panel, most);
    for (std::size_t quarter = 0; quarter < 4; ++quarter) {
      MatrixXd details = corners.middleRows(3 * index_of(k + quarter), 3);
      for (Index corner = 0; corner < 3; ++corner) {
        const Eigen::Vector2d part =
            inverse *
            (mesh.panels()[panel + quarter].corners[static_cast<std::size_t>(corner)] - triangle[0]);
        details.row(corner) -=
            (1 - part.sum()) * whole.row(0) + part[0] * whole.row(1) + part[1] * whole.row(2);
      }
      const MatrixXd energy = films.energy(k + quarter, details);
      result.energies += energy;
      result.group_energies.row(group) += energy.diagonal().transpose();
    }
  }
  for (Index k = 0; k < unknowns.size(); ++k) {
    const auto at = static_cast<std::size_t>(k);
    if (!unknowns.is_charge(k))
      continue;
    const Panel& panel = mesh.panels()[static_cast<std::size_t>(unknowns.panels[at])];
    std::optional<std::pair<std::size_t, bool>> film;
    if (unknowns.kind(k) == PartKind::film)
      film = {static_cast<std::size_t>(unknowns.body[at]) - conductors - bodies.insulators.size(), true};
    else
      film = surroundings.film_on(panel.corners);
    if (!film)
      continue;
    const ThinFilm& layer = bodies.films[film->first];
    // Half of the flux of a panel's own charge leaves on each side; that of others passes through.
    Eigen::RowVectorXd through = Eigen::RowVectorXd::Zero(count);
    for (Index j = 0; j < unknowns.size(); ++j)
      if (unknowns.is_charge(j))
        through +=
            double_layer(unknowns.panels[static_cast<std::size_t>(j)], unknowns.panels[at]) * charges.row(j);
    if (!film->second)
      through = -through;
    const Eigen::RowVectorXd half = charges.row(k) / 2;
    const Eigen::RowVectorXd before = half + through, behind = half - through;
    result.across += 4 * std::numbers::pi * (1 - 1 / layer.ratio) / panel.area *
                     ((layer.thickness - layer.behind) * before.transpose() * before +
                      layer.behind * behind.transpose() * behind);
  }
  return result;
}

/// Returns the energies that the coarse space misses in the groups (rows), for every column of the details.
MatrixXd missed_energies(const PanelMesh& mesh, const Unknowns& unknowns, const MatrixXd& single_layer,
                         const MatrixXd& details) {
  const std::vector<Index> group_of = group_of_panels(mesh);
  MatrixXd energies = MatrixXd::Zero(index_of(mesh.groups().size()), details.cols());
  for (Index k = 0; k < unknowns.size(); ++k) {
    const auto at = static_cast<std::size_t>(k);
    const Index panel = unknowns.panels[at], group = group_of[static_cast<std::size_t>(panel)];
    if (!unknowns.is_charge(k)) {
      /// Energy of a potential that changes by one over a part of size one, over 4π.
      constexpr double energy_of_step = 0.25;
      const Ratios& ratios = unknowns.states[at].ratios;
      energies.row(group) +=
          (energy_of_step * (ratios.behind + ratios.before) / 2 *
           std::sqrt(mesh.panels()[static_cast<std::size_t>(panel)].area) * details.row(k).array().square())
              .matrix();
      continue;
    }
    // Panels of a group are consecutive.
    for (Index l = k;
         l < unknowns.size() &&
         group_of[static_cast<std::size_t>(unknowns.panels[static_cast<std::size_t>(l)])] == group;
         ++l)
      if (unknowns.is_charge(l))
        energies.row(group) +=
            ((l == k ? 1.0 : 2.0) * single_layer(panel, unknowns.panels[static_cast<std::size_t>(l)]) *
             details.row(k).array() * details.row(l).array())
                .matrix();
  }
  return energies.cwiseAbs();
}

/// Returns the largest of the energies in all columns (rows: groups), relative to `own` where that is
/// positive.
VectorXd largest_energies(const MatrixXd& energies, const VectorXd& own) {
  VectorXd result = VectorXd::Zero(energies.rows());
  for (Index c = 0; c < energies.cols(); ++c)
    if (own[c] > 0)
      result = result.cwiseMax(energies.col(c) / own[c]);
  return result;
}

}  // namespace

InsulatedSolution InsulatedSystem::solve(std::size_t set) const {
  const ChargedBodies& bodies = bodies_.conductors;
  const Equations equations = equations_of(mesh_, bodies_, surroundings_[set], single_layer_, double_layer_);
  const Unknowns& unknowns = equations.unknowns;
  const Solutions found = solutions_of(mesh_, equations, equations.potentials);
  const Index conductors = index_of(bodies.conductors.size());
  InsulatedSolution result;
  result.matrix = {MatrixXd::Zero(conductors, conductors), MatrixXd::Zero(conductors, conductors)};
  result.panels = MatrixXd::Zero(index_of(panels()), conductors);
  result.body_charges = MatrixXd::Zero(index_of(bodies.bodies.size()), conductors);
  const auto conductor_of = [&](Index body) {
    return index_of(bodies.bodies[static_cast<std::size_t>(body)].conductor);
  };
  for (Index k = 0; k < unknowns.size(); ++k) {
    const auto at = static_cast<std::size_t>(k);
    result.panels.row(unknowns.panels[at]) = found.fine.row(k);
    if (unknowns.kind(k) != PartKind::conductor)
      continue;
    const Index conductor = conductor_of(unknowns.body[at]);
    result.matrix.fine.row(conductor) += found.fine.row(k);
    result.matrix.coarse.row(conductor) += unknowns.shares[k] * found.coarse.row(unknowns.coarse[at]);
    result.body_charges.row(unknowns.body[at]) += found.fine.row(k);
  }
  if (equations.films) {
    // What flows into the films is free charge of the conductors, too.
    const MatrixXd& lifts = equations.films->lifts();
    for (Index body = 0; body < lifts.cols(); ++body) {
      const Index conductor = conductor_of(body);
      Eigen::RowVectorXd direct = Eigen::RowVectorXd::Zero(conductors);
      for (Index other = 0; other < lifts.cols(); ++other)
        direct[conductor_of(other)] += equations.films->direct()(body, other);
      Eigen::RowVectorXd fine = direct, coarse = direct;
      for (std::size_t k = 0; k < equations.film_unknowns.size(); ++k) {
        const Index unknown = equations.film_unknowns[k];
        const double lift = lifts(index_of(k), body);
        fine += lift * found.fine.row(unknown);
        coarse += lift * unknowns.shares[unknown] *
                  found.coarse.row(unknowns.coarse[static_cast<std::size_t>(unknown)]);
      }
      result.matrix.fine.row(conductor) += fine;
      result.matrix.coarse.row(conductor) += coarse;
      result.body_charges.row(body) += fine;
    }
  }
  MatrixXd energies = missed_energies(mesh_, unknowns, single_layer_, found.details);
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
  energies += films.group_energies;
  result.extrapolated = result.matrix.fine + still_missing * (result.matrix.fine - result.matrix.coarse) +
                        films.across - films.crowding - still_too_stiff * films.energies;
  result.film_effects = films.across + films.crowding;
  result.error_indicators = largest_energies(energies, result.matrix.fine.diagonal());
  result.missed_energies = energies.colwise().sum();
  return result;
}

InsulatedResponse InsulatedSystem::respond(const MatrixXd& outer, const VectorXd& own) const {
  const Equations equations =
      equations_of(mesh_, bodies_, surroundings_.front(), single_layer_, double_layer_);
  const Unknowns& unknowns = equations.unknowns;
  const auto size = static_cast<std::size_t>(unknowns.size());
  MatrixXd right_sides(unknowns.size(), outer.cols());
  for (std::size_t k = 0; k < size; ++k)
    right_sides.row(index_of(k)) = -outer.row(unknowns.panels[k]);
  const Solutions found = solutions_of(mesh_, equations, right_sides);
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
    result.coarse_potentials.row(panel) = found.coarse.row(unknowns.coarse[k]);
  }
  result.energies = largest_energies(missed_energies(mesh_, unknowns, single_layer_, found.details), own);
  return result;
}

std::vector<Index> InsulatedSystem::outermost_panels() const {
  std::vector<Index> result;
  for (std::size_t k = 0; k < panels(); ++k)
    if (surroundings_.front().is_outermost(mesh_.panels()[k].corners))
      result.push_back(index_of(k));
  return result;
}

void InsulatedSystem::refine(const std::vector<bool>& marked, const MatrixXd& panels) {
  mesh_.refine(marked, panels);
}

}  // namespace fringe::detail
