#pragma once

#include <Eigen/Geometry>

#include "collision/gjk_filter.hpp"
#include "fringe/distance_sensor.hpp"

namespace fringe::detail {

/// A convex shape around what a distance sensor sees, for the collision test with a whole object's box: a
/// cone with a flat end, or around wide ones a cylinder.
class ConeShape {
 public:
  ConeShape(const SensingCone& cone, double reach);

  /// True only when nothing within a box, moved by a pose as fringe::transformed() does it, is in the cone
  /// and not beyond the reach. Never wrong; true wherever cone and box are apart by more than rounding.
  bool misses(const Eigen::AlignedBox3d& box, const Eigen::Isometry3d& pose) const;

 private:
  SupportShape shape_{};
  Eigen::Isometry3d pose_ = Eigen::Isometry3d::Identity();
  double coordinates_;  ///< the largest that the cone's own rounding goes with
};

}  // namespace fringe::detail
