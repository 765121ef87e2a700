#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "collision/gjk_filter.hpp"
#include "fringe/distance_sensor.hpp"
#include "fringe/triangle.hpp"

namespace fringe::detail {

/// Conservative tests of boxes and triangles against a cone in plain floating point: whatever rounding could
/// have decided is left open.
class ConeBounds {
 public:
  /// Takes the cone into the frame of the boxes; the pose leads from that frame to the cone's frame of
  /// reference.
  ConeBounds(const SensingCone& cone, const Eigen::Isometry3d& pose);

  /// Returns a lower bound of the distance from the apex to any point of the box.
  double least_distance(const Eigen::AlignedBox3d& box) const;

  /// Returns true only if no point of the box is in the cone.
  bool misses(const Eigen::AlignedBox3d& box) const;

  /// Returns true only if no point of the triangle is in the cone and within the reach.
  bool misses(const Triangle& triangle, double reach) const;

 private:
  template <class Reach>
  bool separated(const Eigen::Vector3d& centre, const Reach& least) const;
  /// Returns the margin that covers the rounding of the coordinates of the apex and the box.
  double allowance(const Eigen::AlignedBox3d& box) const;
  double least_distance(const Triangle& triangle) const;
  bool misses(const Triangle& triangle, const Eigen::AlignedBox3d& box) const;

  Eigen::Vector3d apex_;
  Eigen::Vector3d axis_;
  double cosine_, sine_;
  double pose_rounding_;  ///< relative to the coordinates, no unit
  double apex_allowance_;
};

/// A convex shape that contains the view of a distance sensor, for the collision test with an object's box: a
/// cone with a flat end, or a cylinder for wide views.
class ConeShape {
 public:
  ConeShape(const SensingCone& cone, double reach);

  /// Returns true only if no point of the box, moved by the pose as fringe::transformed() does it, is in the
  /// cone and within the reach. True is never wrong, and is returned wherever cone and box are apart by more
  /// than rounding.
  bool misses(const Eigen::AlignedBox3d& box, const Eigen::Isometry3d& pose) const;

 private:
  SupportShape shape_{};
  Eigen::Isometry3d pose_ = Eigen::Isometry3d::Identity();
  double coordinates_;  ///< largest coordinate of the apex, which scales the cone's rounding errors
};

}  // namespace fringe::detail
