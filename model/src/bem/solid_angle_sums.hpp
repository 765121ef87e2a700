#pragma once

#include <functional>
#include <vector>

#include <Eigen/Core>

#include "bem/panel_mesh.hpp"
#include "surface/insulators.hpp"

/// The solid angles of closed dielectric surfaces, which add up to 4π inside, 2π on them and nothing outside
/// (model/BOUNDARY_ELEMENTS.md, section 13).
namespace fringe::detail {

struct InsulatedUnknowns;

/// Where a mean of the potential is taken, on a panel or a part of one.
struct AngleTarget {
  double mean;             ///< of the permittivities on both sides, over the medium's
  Eigen::Index component;  ///< that it lies on; `AngleSums::unknown` if that is not known
};

/// Corrects the errors of quadratures in the sums of solid angles. Multiplied by a permittivity of a thousand
/// they would charge a body as a whole, and its potential would be lost.
class AngleSums {
 public:
  static constexpr Eigen::Index unknown = -1;

  /// The means over all targets of the solid angle of an unknown's panel, over 4π.
  using Column = std::function<Eigen::VectorXd(Eigen::Index unknown)>;

  /// `components` are those of the unknowns, from components_of().
  AngleSums(const InsulatedUnknowns& unknowns, const std::vector<Eigen::Index>& components,
            const std::vector<AngleTarget>& targets, const Column& column);

  /// Returns a column times the jump of the permittivity, its elements corrected in proportion to their size
  /// so that the sum over the component is right.
  Eigen::VectorXd corrected(Eigen::Index unknown, const Eigen::VectorXd& column) const;

 private:
  std::vector<double> jumps_;             ///< of each unknown
  std::vector<Eigen::Index> components_;  ///< of each unknown
  Eigen::MatrixXd factors_;               ///< of targets (rows) and components
};

/// Returns for each unknown the set of dielectric bodies that touch each other whose surface it is a part of;
/// AngleSums::unknown for the others.
std::vector<Eigen::Index> components_of(const PanelMesh& mesh, const InsulatedBodies& bodies,
                                        const InsulatedUnknowns& unknowns);

}  // namespace fringe::detail
