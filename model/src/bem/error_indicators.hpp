#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Core>

#include "bem/panel_mesh.hpp"
#include "surface/bodies.hpp"

/// Error indicators: the energy that the charges of faces and panels miss. `charges` have one column for
/// every right-hand side, such as a conductor at unit potential; `own` are the energies of these solutions.
namespace fringe::detail {

/// The quarters of a sample of the unrefined elements, four for each.
struct SampledQuarters {
  std::vector<Panel> panels;         ///< empty if every panel was divided
  std::vector<std::size_t> bodies;   ///< of each panel
  std::vector<std::size_t> parents;  ///< of each panel, the panel of the mesh that it is a quarter of
  double weight = 0;                 ///< number of unrefined elements for each one sampled
};
SampledQuarters sampled_quarters(const PanelMesh& mesh);

/// Returns the energy that the charges of all unrefined elements' quarters would gain, estimated from the
/// sample: a symmetric matrix of all pairs of columns. The charges make up for `missing_potentials`, the
/// potentials that lack on the sampled quarters (rows), and add up to zero on each element.
Eigen::MatrixXd energy_of_quarters(const SampledQuarters& quarters, const Eigen::MatrixXd& missing_potentials,
                                   double tolerance);

/// Returns for every group of panels (rows) the energies that its panels' own densities add to those of one
/// density, in each column. `blocks` are those of each group's panels with each other, `shares` is
/// area_shares, and `charges` are the panels'.
Eigen::MatrixXd detail_energies(const PanelMesh& mesh, const std::vector<Eigen::MatrixXd>& blocks,
                                const Eigen::VectorXd& shares, const Eigen::MatrixXd& charges);

/// Returns the energies between all pairs of columns, all counted as positive, from those in each column.
Eigen::MatrixXd energies_of_pairs(const Eigen::MatrixXd& energies);

/// Returns the largest energy of every row, relative to that of its column, where this is positive.
Eigen::VectorXd largest_parts(const Eigen::MatrixXd& energies, const Eigen::VectorXd& own);

/// Returns the same for the changes of readings, relative to `scales`, from the energies in the columns of
/// ReadingCharges::all().
Eigen::VectorXd largest_parts_of_change(const Eigen::MatrixXd& energies, const Eigen::VectorXd& scales);

/// Returns for every group of panels (rows) the energies that the facets of round shapes may be wrong by once
/// they are added to the answer. `charges` are the panels'.
Eigen::MatrixXd facet_energies(const PanelMesh& mesh, const ChargedBodies& bodies,
                               const Eigen::MatrixXd& charges);

/// Returns for every group of panels the largest error of an entry by the facets of round shapes, relative to
/// `scales`. `charges` are the panels' for every conductor at unit potential that is not floating.
Eigen::VectorXd facet_indicators(const PanelMesh& mesh, const ChargedBodies& bodies,
                                 const Eigen::MatrixXd& charges, const Eigen::ArrayXXd& scales);

/// Divides what panels that were never divided would gain from division, relative to the solutions' energies,
/// among their groups: those with more charge get a larger part. `charges` are the panels'.
Eigen::VectorXd unrefined_indicators(const PanelMesh& mesh, const std::vector<Eigen::MatrixXd>& blocks,
                                     const Eigen::MatrixXd& charges, const Eigen::VectorXd& own, double part);

}  // namespace fringe::detail
