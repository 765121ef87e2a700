#pragma once

#include <Eigen/Geometry>

#include "collision/gjk_filter.hpp"
#include "fringe/distance_sensor.hpp"

namespace fringe::detail {

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
