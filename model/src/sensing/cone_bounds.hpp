#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "fringe/distance_sensor.hpp"
#include "fringe/triangle.hpp"

namespace fringe::detail {

/// What can be said of boxes and triangles and a cone in plain floating point. Never wrong: whatever rounding
/// could have decided is left open.
class ConeBounds {
 public:
  /// The cone as seen from where the boxes are; the pose leads from there to the cone's frame of reference.
  ConeBounds(const SensingCone& cone, const Eigen::Isometry3d& pose);

  /// No point of the box is nearer to the apex than this.
  double least_distance(const Eigen::AlignedBox3d& box) const;

  /// True only when no point of the box is in the cone.
  bool misses(const Eigen::AlignedBox3d& box) const;

  /// True only when no point of the triangle is in the cone and not beyond the reach.
  bool misses(const Triangle& triangle, double reach) const;

 private:
  template <class Reach>
  bool separated(const Eigen::Vector3d& centre, const Reach& least) const;
  double allowance(const Eigen::AlignedBox3d& box) const;
  double least_distance(const Triangle& triangle) const;
  bool misses(const Triangle& triangle, const Eigen::AlignedBox3d& box) const;

  Eigen::Vector3d apex_;
  Eigen::Vector3d axis_;
  double cosine_, sine_;
  double pose_rounding_;  ///< relative to the coordinates
  double apex_allowance_;
};

}  // namespace fringe::detail
