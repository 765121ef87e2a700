#include "bem/insulated_equations.hpp"

#include <algorithm>
#include <utility>

#include "numeric/interruption.hpp"
#include "numeric/parallel.hpp"

namespace fringe::detail {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

InsulatedUnknowns insulated_unknowns(const PanelMesh& mesh, const Surroundings& surroundings,
                                     const ClusterTree& tree) {
  InsulatedUnknowns result;
  CombinedFunctions& coarse = result.coarse;
  std::vector<double> areas, whole;
  for (const Index g : tree.groups()) {
    check_interruption();
    const PanelGroup& group = mesh.groups()[static_cast<std::size_t>(g)];
    std::vector<std::pair<PartState, Index>> places;
    for (std::size_t panel = group.first; panel < group.first + group.count; ++panel) {
      const PartState state = surroundings.state(mesh.panels()[panel].corners, group.body);
      if (state.kind == PartKind::absent)
        continue;
      auto place =
          std::find_if(places.begin(), places.end(), [&](const auto& known) { return known.first == state; });
      if (place == places.end()) {
        place = places.insert(places.end(), {state, coarse.size++});
        whole.push_back(0);
      }
      result.panels.push_back(index_of(panel));
      result.places.push_back(tree.places()[panel]);
      result.states.push_back(state);
      result.body.push_back(index_of(group.body));
      coarse.place.push_back(place->second);
      areas.push_back(mesh.panels()[panel].area);
      whole[static_cast<std::size_t>(place->second)] += areas.back();
    }
  }
  result.areas = Eigen::Map<const VectorXd>(areas.data(), index_of(areas.size()));
  result.centres.resize(3, result.size());
  for (Index k = 0; k < result.size(); ++k)
    result.centres.col(k) =
        mesh.panels()[static_cast<std::size_t>(result.panels[static_cast<std::size_t>(k)])].centre;
  coarse.shares.resize(result.size());
  coarse.parts = VectorXd::Ones(result.size());
  for (Index k = 0; k < result.size(); ++k) {
    const auto at = static_cast<std::size_t>(k);
    coarse.shares[k] = areas[at] / whole[static_cast<std::size_t>(coarse.place[at])];
    if (result.is_charge(k))
      coarse.parts[k] = coarse.shares[k];
  }
  return result;
}

/// Returns the films of a set of bodies, and adds them to the equations.
void add_films(const PanelMesh& mesh, const InsulatedBodies& bodies, const Surroundings& surroundings,
               InsulatedEquations& equations) {
  const InsulatedUnknowns& unknowns = equations.unknowns;
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
  equations.matrix.add_films(own, equations.films->compliance());
  for (std::size_t body = 0; body < conductors; ++body)
    equations.potentials(own, index_of(bodies.conductors.bodies[body].conductor)) +=
        equations.films->lifts().col(index_of(body));
}

}  // namespace

AngleTarget InsulatedEquations::target(Index k) const {
  const auto at = static_cast<std::size_t>(k);
  const Ratios& ratios = unknowns.states[at].ratios;
  return {(ratios.behind + ratios.before) / 2, components[at]};
}

InsulatedEquations insulated_equations(const PanelMesh& mesh, const InsulatedBodies& bodies,
                                       const Surroundings& surroundings, const PanelOperator& single_layer,
                                       const DoubleLayer& double_layer, std::size_t threads) {
  InsulatedEquations result;
  result.threads = threads;
  result.unknowns = insulated_unknowns(mesh, surroundings, single_layer.tree());
  const InsulatedUnknowns& unknowns = result.unknowns;
  const Index size = unknowns.size();
  const auto conductor_of = [&](Index k) {
    const Index body = unknowns.body[static_cast<std::size_t>(k)];
    return index_of(bodies.conductors.bodies[static_cast<std::size_t>(body)].conductor);
  };
  result.components = components_of(mesh, bodies, unknowns);
  std::vector<AngleTarget> targets;
  std::vector<Index> interfaces;
  for (Index k = 0; k < size; ++k) {
    targets.push_back(result.target(k));
    if (!unknowns.is_charge(k))
      interfaces.push_back(k);
  }
  const auto column = [&](Index k) {
    return double_layer.column(unknowns.panels, unknowns.panels[static_cast<std::size_t>(k)]);
  };
  const AngleSums angles(unknowns, result.components, targets, column);
  const auto layer = [&](Index k) {
    VectorXd elements = angles.corrected(k, column(k));
    elements[k] -= targets[static_cast<std::size_t>(k)].mean;
    return elements;
  };
  MatrixXd dipoles(size, index_of(interfaces.size()));
  parallel_for(interfaces.size(), threads,
               [&](std::size_t k) { dipoles.col(index_of(k)) = layer(interfaces[k]); });
  result.potentials = MatrixXd::Zero(size, index_of(bodies.conductors.conductors.size()));
  for (Index k = 0; k < size; ++k) {
    if (unknowns.kind(k) != PartKind::conductor)
      continue;
    const Ratios& ratios = unknowns.states[static_cast<std::size_t>(k)].ratios;
    auto potentials = result.potentials.col(conductor_of(k));
    if (ratios.behind != ratios.before)
      potentials -= layer(k);
    else
      potentials[k] += targets[static_cast<std::size_t>(k)].mean;
  }
  result.matrix = InsulatedMatrix(single_layer, unknowns, std::move(dipoles), threads);
  if (!bodies.films.empty())
    add_films(mesh, bodies, surroundings, result);
  return result;
}

}  // namespace fringe::detail
