#include "bem/film_effects.hpp"

#include <algorithm>
#include <array>
#include <iterator>
#include <numbers>
#include <optional>

namespace fringe::detail {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::RowVectorXd;

/// Returns the potentials at the corners of the films' panels, three rows for each.
MatrixXd potentials_along(const InsulatedBodies& bodies, const InsulatedEquations& equations,
                          const MatrixXd& charges) {
  MatrixXd at_unit = MatrixXd::Zero(index_of(bodies.conductors.bodies.size()), charges.cols());
  for (std::size_t body = 0; body < bodies.conductors.bodies.size(); ++body)
    at_unit(index_of(body), index_of(bodies.conductors.bodies[body].conductor)) = 1;
  return equations.films->corner_potentials(charges(equations.film_unknowns, Eigen::all), at_unit);
}

/// Adds the energy that the potential on the quarters of a panel has beyond that of the panel, and finds the
/// side along which it bends most.
/// @param first place of the first quarter among the films' panels
/// @param corners the potentials at the corners of all films' panels
void add_bending(const PanelMesh& mesh, const FilmSheets& films, std::size_t first, Index group,
                 const MatrixXd& corners, FilmEffects& effects) {
  const PanelGroup& panels = mesh.groups()[static_cast<std::size_t>(group)];
  // The first three quarters are those at the corners, in their order; so are their corners.
  MatrixXd whole(3, corners.cols());
  for (Index corner = 0; corner < 3; ++corner)
    whole.row(corner) = corners.row(3 * (index_of(first) + corner) + corner);
  const Triangle triangle = mesh.triangles(panels).front();
  const Eigen::Vector3d second = triangle[1] - triangle[0], third = triangle[2] - triangle[0];
  Eigen::Matrix<double, 3, 2> sides;
  sides << second, third;
  const Eigen::Matrix<double, 2, 3> inverse = (sides.transpose() * sides).inverse() * sides.transpose();
  // The middles of the sides are corners of the first and second quarter.
  constexpr std::array<Index, 3> middles{1, 5, 2};
  std::array<double, 3> bends{};
  for (Index side = 0; side < 3; ++side)
    bends[static_cast<std::size_t>(side)] =
        (corners.row(3 * index_of(first) + middles[static_cast<std::size_t>(side)]) -
         (whole.row(side) + whole.row((side + 1) % 3)) / 2)
            .squaredNorm();
  const auto most = std::distance(bends.begin(), std::max_element(bends.begin(), bends.end()));
  effects.bent.push_back({panels.first, static_cast<std::size_t>(most)});
  for (std::size_t quarter = 0; quarter < 4; ++quarter) {
    MatrixXd details = corners.middleRows(3 * index_of(first + quarter), 3);
    for (Index corner = 0; corner < 3; ++corner) {
      const Eigen::Vector2d part =
          inverse *
          (mesh.panels()[panels.first + quarter].corners[static_cast<std::size_t>(corner)] - triangle[0]);
      details.row(corner) -=
          (1 - part.sum()) * whole.row(0) + part[0] * whole.row(1) + part[1] * whole.row(2);
    }
    const MatrixXd energy = films.energy(first + quarter, details);
    effects.energies += energy;
    effects.group_energies.row(group) += energy.diagonal().transpose();
  }
}

/// Adds the energies of the potential along films, and what their thickness takes away beside conductors.
void add_effects_along(const PanelMesh& mesh, const InsulatedBodies& bodies,
                       const InsulatedEquations& equations, const MatrixXd& charges, FilmEffects& effects) {
  const std::vector<Index>& panels = equations.unknowns.panels;
  const std::vector<Index>& own = equations.film_unknowns;
  const std::vector<Index> group_of = mesh.group_of_panels();
  const MatrixXd corners = potentials_along(bodies, equations, charges);
  for (std::size_t k = 0; k < own.size(); ++k) {
    effects.crowding += equations.films->crowding(k, corners.middleRows(3 * index_of(k), 3));
    const Index panel = panels[static_cast<std::size_t>(own[k])];
    const Index group = group_of[static_cast<std::size_t>(panel)];
    const PanelGroup& quarters = mesh.groups()[static_cast<std::size_t>(group)];
    // Only panels all of whose quarters belong to the film.
    if (quarters.is_quartered && panel == index_of(quarters.first) && k + 4 <= own.size() &&
        panels[static_cast<std::size_t>(own[k + 3])] == panel + 3)
      add_bending(mesh, *equations.films, k, group, corners, effects);
  }
}

/// Adds what the thickness of films displaces of the flux that crosses them.
void add_effects_across(const PanelMesh& mesh, const InsulatedBodies& bodies,
                        const Surroundings& surroundings, const InsulatedEquations& equations,
                        const DoubleLayer& double_layer, const MatrixXd& charges, FilmEffects& effects) {
  const InsulatedUnknowns& unknowns = equations.unknowns;
  const std::size_t others = bodies.conductors.bodies.size() + bodies.insulators.size();
  for (Index k = 0; k < unknowns.size(); ++k) {
    if (!unknowns.is_charge(k))
      continue;
    const auto at = static_cast<std::size_t>(k);
    const Panel& panel = mesh.panels()[static_cast<std::size_t>(unknowns.panels[at])];
    const std::optional<std::pair<std::size_t, bool>> film =
        unknowns.kind(k) == PartKind::film
            ? std::pair(static_cast<std::size_t>(unknowns.body[at]) - others, true)
            : surroundings.film_on(panel.corners);
    if (!film)
      continue;
    const ThinFilm& layer = bodies.films[film->first];
    // Half of the flux of a panel's own charge leaves on each side; that of others passes through.
    RowVectorXd through = RowVectorXd::Zero(charges.cols());
    for (Index j = 0; j < unknowns.size(); ++j)
      if (unknowns.is_charge(j))
        through +=
            double_layer(unknowns.panels[static_cast<std::size_t>(j)], unknowns.panels[at]) * charges.row(j);
    if (!film->second)
      through = -through;
    const RowVectorXd half = charges.row(k) / 2;
    const RowVectorXd before = half + through, behind = half - through;
    effects.across += 4 * std::numbers::pi * (1 - 1 / layer.ratio) / panel.area *
                      ((layer.thickness - layer.behind) * before.transpose() * before +
                       layer.behind * behind.transpose() * behind);
  }
}

}  // namespace

FilmEffects film_effects(const PanelMesh& mesh, const InsulatedBodies& bodies,
                         const Surroundings& surroundings, const InsulatedEquations& equations,
                         const DoubleLayer& double_layer, const MatrixXd& charges) {
  const Index count = charges.cols();
  const MatrixXd none = MatrixXd::Zero(count, count);
  FilmEffects result{MatrixXd::Zero(index_of(mesh.groups().size()), count), {}, none, none, none};
  if (!equations.films)
    return result;
  add_effects_along(mesh, bodies, equations, charges, result);
  add_effects_across(mesh, bodies, surroundings, equations, double_layer, charges, result);
  return result;
}

}  // namespace fringe::detail
