#include "bem/simplification_effects.hpp"

#include <numbers>
#include <vector>

namespace fringe::detail {

using Eigen::MatrixXd;

Eigen::VectorXd deviation_effects(const Simplification& simplification, const PanelMesh& mesh) {
  Eigen::VectorXd effects = Eigen::VectorXd::Zero(index_of(mesh.panels().size()));
  const std::vector<ChargedBody>& bodies = simplification.bodies().bodies;
  for (const PanelGroup& group : mesh.groups()) {
    // A simplified surface that stands for a round shape is as far from this as its panels are.
    if (group.body >= bodies.size() || round_shape_of(bodies[group.body].surface) != nullptr)
      continue;
    for (std::size_t k = group.first; k < group.first + group.count; ++k) {
      const Panel& panel = mesh.panels()[k];
      effects[index_of(k)] =
          4 * std::numbers::pi * simplification.deviation(group.body, panel.centre) / panel.area;
    }
  }
  return effects;
}

SurfaceEffects surface_effects(const Simplification& simplification, const PanelMesh& mesh,
                               const MatrixXd& charges) {
  const MatrixXd none = MatrixXd::Zero(charges.cols(), charges.cols());
  SurfaceEffects effects{none, none, none};
  if (charges.cols() == 0)
    return effects;
  const Eigen::VectorXd of_deviations = deviation_effects(simplification, mesh);
  for (const PanelGroup& group : mesh.groups())
    for (std::size_t k = group.first; k < group.first + group.count; ++k) {
      const Panel& panel = mesh.panels()[k];
      const Eigen::RowVectorXd own = charges.row(index_of(k)), absolute = own.cwiseAbs();
      if (const RoundShape* const round =
              round_shape_of(simplification.bodies().bodies[group.body].surface)) {
        const double lack = round->lack_per_squared_charge(panel);
        const double along_rim = round->lack_along_rim(panel, absolute.maxCoeff());
        if (lack + along_rim == 0)
          continue;
        if (round->is_lack_added())
          effects.facets += lack * own.transpose() * own;
        (round->is_followed() ? effects.facet_errors : effects.lasting_errors) +=
            round->error_per_lack() * (lack + along_rim) * absolute.transpose() * absolute;
      } else if (const double effect = of_deviations[index_of(k)]; effect > 0) {
        effects.lasting_errors += effect * absolute.transpose() * absolute;
      }
    }
  return effects;
}

}  // namespace fringe::detail
