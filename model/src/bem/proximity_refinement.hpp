#pragma once

#include <vector>

#include <Eigen/Core>

#include "bem/bodies.hpp"

namespace fringe::detail {

/// What a body does to the charge of another: about as wide as the body is, and their distance more. Where it
/// is narrower than what the charge is made of, answers that all miss it agree (model/BOUNDARY_ELEMENTS.md,
/// section 6).
class Shadow {
 public:
  explicit Shadow(const ChargedBody& body);

  /// Whether it is over within less than the largest number of functions can see along a direction of a face.
  bool is_narrow_on(const ChargedFace& face) const;

  /// Whether it is so much smaller than a triangle that the triangle's parts would not see it.
  bool is_narrow_on(const Triangle& triangle) const;

 private:
  std::vector<Eigen::Vector3d> corners_;
  Eigen::Vector3d centre_;
  double radius_;               ///< of a ball about the centre that holds the corners
  Eigen::Matrix3d half_edges_;  ///< of a box around the body, along its own axes
  double half_width_;           ///< the middle one of their lengths: a strip's width
};

/// One for each body.
std::vector<Shadow> shadows_of(const ChargedBodies& bodies);

}  // namespace fringe::detail
