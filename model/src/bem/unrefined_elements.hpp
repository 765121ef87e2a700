#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

#include "bem/panel_mesh.hpp"

/// What panels that were never divided hide (model/BOUNDARY_ELEMENTS.md, section 9).
namespace fringe::detail {

/// The quarters of some of them, four after four, for all.
struct SampledQuarters {
  std::vector<Panel> panels;  ///< none if every panel was divided
  double weight = 0;          ///< how many undivided panels there are for each that is sampled
};
SampledQuarters sampled_quarters(const PanelMesh& mesh);

/// The energy of the charges that all undivided panels' quarters take for what the potential lacks on those
/// sampled (rows), without any net charge: a symmetric matrix of all pairs of columns.
Eigen::MatrixXd energy_of_quarters(const SampledQuarters& quarters, const Eigen::MatrixXd& lacking,
                                   double tolerance);

}  // namespace fringe::detail
