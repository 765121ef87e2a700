#pragma once

#include <vector>

#include <Eigen/Core>

#include "bem/insulated_equations.hpp"

/// First-order effect of the facets of round conductors and dielectric bodies beside each other
/// (model/BOUNDARY_ELEMENTS.md, section 13).
namespace fringe::detail {

/// A sample of the interfaces that stand for round shapes, with a copy of each panel outside of it.
struct BesideFacets {
  static constexpr int rows = 3;    ///< of the roots of errors for each panel
  std::vector<std::size_t> panels;  ///< of the sample
  std::vector<std::size_t> groups;  ///< of these
  std::vector<double> depths;       ///< m, from each to its shape's surface, with the weight in the sample
  std::vector<bool> are_added;      ///< RoundShape::is_lack_added() of the shapes
  std::vector<Panel> beside;        ///< the copies
  DoubleLayer double_layer;         ///< of all panels, as means over the copies (rows)
};

/// Returns the sample, without its double layer.
BesideFacets beside_facets(const PanelMesh& mesh, const InsulatedBodies& bodies);

/// The differences between the capacitances of round shapes and of the polyhedra that stand for them.
struct FacetEffects {
  Eigen::MatrixXd added;  ///< between conductors, where the effect is known well enough to be added
  /// Roots of the errors: three rows for each panel, a column for each conductor at unit potential.
  Eigen::MatrixXd errors;
  Eigen::MatrixXd lasting;  ///< the same, of panels that do not follow their shape when they are divided
  Eigen::MatrixXd groups;   ///< energies of the errors of groups (rows) that do, for each conductor
};

/// Returns the effects. By Hadamard's formula an interface that moves by a small distance along its normal
/// changes capacitances by the jump of the permittivity times the field along it and the flux across it.
FacetEffects facet_effects(const PanelMesh& mesh, const InsulatedBodies& bodies,
                           const InsulatedEquations& equations, const BesideFacets& facets,
                           const Eigen::MatrixXd& values, double tolerance);

}  // namespace fringe::detail
