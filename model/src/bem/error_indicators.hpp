#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "bem/panel_equations.hpp"
#include "bem/panel_mesh.hpp"

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

/// Returns for every group of panels the energy that its panels' own densities add to that of one density. It
/// is relative to the energy of each solution, and the largest of these. `blocks` are those of
/// each group's panels with each other, `shares` is area_shares, and `charges` are the panels'.
Eigen::VectorXd error_indicators(const PanelMesh& mesh, const std::vector<Eigen::MatrixXd>& blocks,
                                 const Eigen::VectorXd& shares, const Eigen::MatrixXd& charges,
                                 const Eigen::VectorXd& own);

/// Returns the energies that the panels' own densities add to those of one density on each group, all counted
/// as positive, between all pairs of columns.
Eigen::MatrixXd detail_energies(const PanelMesh& mesh, const std::vector<Eigen::MatrixXd>& blocks,
                                const Eigen::VectorXd& shares, const Eigen::MatrixXd& charges);

/// Returns the same as error_indicators() for the changes of readings, relative to `scales`. `charges` are
/// the panels' in the columns of ReadingCharges::all().
Eigen::VectorXd change_indicators(const PanelMesh& mesh, const std::vector<Eigen::MatrixXd>& blocks,
                                  const Eigen::VectorXd& shares, const Eigen::MatrixXd& charges,
                                  const Eigen::VectorXd& scales);

/// Returns for every group of panels (rows) the energies that the facets of round shapes may be wrong by once
/// they are added to the answer. `charges` are the panels'.
Eigen::MatrixXd facet_energies(const PanelMesh& mesh, const ChargedBodies& bodies,
                               const Eigen::MatrixXd& charges);

/// Returns for every group of panels the largest error of an entry by the facets of round shapes, relative to
/// `scales`. `charges` are the panels' for every conductor at unit potential that is not floating.
Eigen::VectorXd facet_indicators(const PanelMesh& mesh, const ChargedBodies& bodies,
                                 const Eigen::MatrixXd& charges, const Eigen::ArrayXXd& scales);

/// The energy that unrefined elements, panels that were never divided, would gain from division. `charges`
/// are those of all unknowns.
struct UnrefinedEnergy {
  Eigen::MatrixXd gained;      ///< by every pair of conductors, summed over all panels; empty if there are no
                               ///< unrefined elements
  Eigen::VectorXd groups;      ///< by every group, as in error_indicators()
  Eigen::MatrixXd background;  ///< as `gained`, without the targets
};
/// `background_charges` are those without the targets, whose bodies `is_target` tells; none: not asked for.
UnrefinedEnergy unrefined_energy(const PanelEquations& equations, const std::vector<Eigen::MatrixXd>& blocks,
                                 const Eigen::MatrixXd& charges, const Eigen::MatrixXd& background_charges,
                                 const std::vector<bool>& is_target, const Eigen::VectorXd& own,
                                 double tolerance);

}  // namespace fringe::detail
