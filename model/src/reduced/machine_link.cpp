#include "reduced/machine_link.hpp"

#include <algorithm>
#include <functional>
#include <utility>

#include "readings/maxwell_matrix.hpp"

namespace fringe::detail {
namespace {

using Eigen::AlignedBox3d;
using Eigen::Index;
using Eigen::MatrixXd;

/// Size of a part of a link relative to its distance from what is sensed or driven, below which it is not
/// divided: measured on the machines of model/CORRECTIONS.md, section 8.
constexpr double fine_enough = 0.5;

/// Returns the size of a part relative to its distance from what is sensed or driven.
double size_of(const AlignedBox3d& part, const std::vector<PlacedBox>& used, const Approach& approach) {
  return std::max(relative_size(part, used), approach.relative_size(part));
}

/// Marks the conductors whose charges have to be accurate; all if the readings use none of them.
void ask(ChargedBodies& bodies, const std::vector<ChargedReading>& readings) {
  bool is_any_asked = false;
  for (std::size_t k = 0; k < bodies.conductors.size(); ++k) {
    const Index at = index_of(k);
    bodies.conductors[k].is_asked = bodies.conductors[k].role == Role::floating ||
                                    std::ranges::any_of(readings, [&](const ChargedReading& reading) {
                                      return reading.sense[at] != 0 || reading.drive[at] != 0;
                                    });
    is_any_asked = is_any_asked || bodies.conductors[k].is_asked;
  }
  if (!is_any_asked)
    for (ChargedConductor& conductor : bodies.conductors)
      conductor.is_asked = true;
}

/// Returns the given charges of the panels: those of the loads that the bodies carry, and what these lack
/// with one density on each group of panels.
MatrixXd given_charges(const ConductorsAtRest& conductors, const MatrixXd& loads,
                       const std::vector<Index>& carried) {
  const MatrixXd all = potentials(conductors.matrix(), conductors.bodies());
  const MatrixXd potentials_of_loads = all * loads(Eigen::seqN(0, all.cols()), carried);
  MatrixXd given(conductors.charges().rows(), 2 * index_of(carried.size()));
  given << conductors.charges() * potentials_of_loads,
      (conductors.charges() - conductors.coarse_charges()) * potentials_of_loads;
  return given;
}

/// Returns the Maxwell matrix of loads, without charge on what floats.
MatrixXd own_matrix(const ConductorsAtRest& conductors, const MatrixXd& loads,
                    const std::vector<Index>& carried) {
  const MatrixXd matrix = without_floating(conductors.matrix(), conductors.bodies());
  const MatrixXd potentials = loads(Eigen::seqN(0, matrix.rows()), carried);
  return potentials.transpose() * matrix * potentials;
}

std::vector<Index> carried_by(const MatrixXd& loads) {
  std::vector<Index> carried;
  for (Index load = 0; load < loads.cols(); ++load)
    if (!loads.col(load).isZero(0))
      carried.push_back(load);
  return carried;
}

}  // namespace

MachineLink::MachineLink(ChargedBodies bodies, const std::vector<ChargedReading>& readings,
                         const MatrixXd& loads, const Approach& approach, const Approach& to_targets,
                         const SurfaceResolution& resolution)
    : MachineLink(
          [&] {
            ask(bodies, readings);
            const std::vector<PlacedBox> used = boxes_of_used(bodies, readings);
            std::function<double(const AlignedBox3d&)> importance;
            if (resolution.least_panels > 0)
              importance = [&, used](const AlignedBox3d& box) { return size_of(box, used, approach); };
            return ConductorsAtRest(std::move(bodies), resolution.rtol, resolution.most_panels,
                                    resolution.least_panels, resolution.threads, importance);
          }(),
          readings, loads, approach, to_targets, resolution) {}

MachineLink::MachineLink(const ConductorsAtRest& conductors, const std::vector<ChargedReading>& readings,
                         const MatrixXd& loads, const Approach& approach, const Approach& to_targets,
                         const SurfaceResolution& resolution)
    : loads_(carried_by(loads)), own_(own_matrix(conductors, loads, loads_)), error_(conductors.error()),
      excess_(error_ / resolution.rtol), functions_([&] {
        const std::vector<PlacedBox> used = boxes_of_used(conductors.bodies(), readings);
        const MatrixXd given = given_charges(conductors, loads, loads_);
        const auto importance = [&](const ChargeFunctions::Part& part) {
          const double size = size_of(part.box, used, approach);
          if (to_targets.boxes.empty())
            return size;
          return size > fine_enough ? size * to_targets.relative_size(part.box) : 0;
        };
        ChargeFunctions functions(conductors, given, importance, resolution.functions);
        // Where fewer are fine enough, the sums of neighbours have to be half as many as these.
        return functions.count() < resolution.functions
                   ? ChargeFunctions(conductors, given, importance, functions.count())
                   : functions;
      }()),
      net_(net_on_floating(functions_, conductors.bodies()).cast<float>()),
      to_ground_(to_ground_of(conductors.bodies())),
      coarse_(functions_, net_on_floating(functions_, conductors.bodies()), to_ground_),
      energies_(functions_.energies().cast<float>()) {
  /// Ratio of the stated error of the loads' own matrix to that of the charges: in 156 scenes of
  /// `python3 -m analysis honesty` values were off by up to 1.7 times the latter.
  constexpr double stated_per_error = 1.75;
  own_error_ = stated_per_error * error_ + functions_.facet_effect_of_given();
}

}  // namespace fringe::detail
