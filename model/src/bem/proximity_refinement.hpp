#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Core>

#include "bem/panel_mesh.hpp"
#include "surface/bodies.hpp"

namespace fringe::detail {

/// The charge that a body induces on another one close by: about as wide as the body and their distance
/// together. Where it is narrower than the elements of the charge, solutions that all miss it agree
/// (model/BOUNDARY_ELEMENTS.md, section 6).
class InducedCharge {
 public:
  explicit InducedCharge(const ChargedBody& body);

  /// Returns true if the induced charge is narrower than the largest number of functions can resolve along a
  /// direction of a face.
  bool is_narrow_on(const ChargedFace& face) const;

  /// Returns true if the induced charge is so much smaller than a triangle that the triangle's parts would
  /// not resolve it.
  bool is_narrow_on(const Triangle& triangle) const;

 private:
  std::vector<Eigen::Vector3d> corners_;
  Eigen::Vector3d centre_;
  double radius_;               ///< of a ball about the centre that contains the corners
  Eigen::Matrix3d half_edges_;  ///< columns: half edges of a box around the body, along its own axes
  double half_width_;           ///< the middle one of their lengths: half the width of a strip
};

/// Returns the charge that each body induces on others.
std::vector<InducedCharge> induced_charges(const ChargedBodies& bodies);

/// Divides the panels of each body, given by its number, until they resolve the charges that the others
/// induce, or there are `most_panels`.
void refine_by_proximity(PanelMesh& mesh, const ChargedBodies& bodies, std::size_t most_panels);

}  // namespace fringe::detail
