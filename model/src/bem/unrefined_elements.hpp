#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

#include "bem/panel_mesh.hpp"

/// Estimates what unrefined elements, panels that were never divided, miss (model/BOUNDARY_ELEMENTS.md,
/// section 9).
namespace fringe::detail {

/// The quarters of a sample of the unrefined elements, four for each.
struct SampledQuarters {
  std::vector<Panel> panels;  ///< empty if every panel was divided
  double weight = 0;          ///< number of unrefined elements for each one sampled
};
SampledQuarters sampled_quarters(const PanelMesh& mesh);

/// Returns the energy that the charges of all unrefined elements' quarters would gain, estimated from the
/// sample: a symmetric matrix of all pairs of columns. The charges make up for `lacking`, the potentials that
/// lack on the sampled quarters (rows), and add up to zero on each element.
Eigen::MatrixXd energy_of_quarters(const SampledQuarters& quarters, const Eigen::MatrixXd& lacking,
                                   double tolerance);

}  // namespace fringe::detail
