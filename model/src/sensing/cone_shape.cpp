#include "sensing/cone_shape.hpp"

#include <cmath>

#include "simd/dispatch.hpp"

namespace fringe::detail {
namespace {

using Eigen::Vector3d;

/// Relative enlargement that covers `boundary_width` and the rounding of the cone's sizes and pose.
constexpr double widened = 1 + 0x1p-40;

/// Bound on the displacement of an apex or a vertex by rounding, relative to its coordinates and the pose's,
/// with room to spare.
constexpr double placing_rounding = 0x1p-46;

/// Half angle in radians above which the base of a cone would be far wider than the view; a cylinder is used
/// there.
constexpr double widest = 1.0;

}  // namespace

ConeShape::ConeShape(const SensingCone& cone, double reach) : coordinates_(cone.apex.cwiseAbs().maxCoeff()) {
  const double half_angle = cone.full_angle / 2, length = reach * widened;
  const bool is_wide = half_angle > widest;
  const double radius = is_wide ? length : length * std::tan(half_angle) * widened;
  shape_.kind = is_wide ? ShapeKind::cylinder : ShapeKind::cone;
  shape_.size[0] = radius;
  shape_.size[1] = length / 2;
  shape_.bounding_radius = std::hypot(radius, length / 2) * widened;
  // The apex is the upper end of the cone shape; how the shape is turned about its axis does not matter.
  const Vector3d axis = cone.direction.stableNormalized(), across = axis.unitOrthogonal();
  pose_.linear() << across, across.cross(axis), -axis;
  pose_.translation() = cone.apex + length / 2 * axis;
}

bool ConeShape::misses(const Eigen::AlignedBox3d& box, const Eigen::Isometry3d& pose) const {
  const Vector3d centre = box.min() / 2 + box.max() / 2;
  const double farthest = box.min().cwiseAbs().cwiseMax(box.max().cwiseAbs()).maxCoeff();
  const double rounding =
      placing_rounding * (farthest + coordinates_ + pose.translation().cwiseAbs().maxCoeff()) +
      (widened - 1) * shape_.bounding_radius;
  const Vector3d half = ((box.max() / 2 - box.min() / 2).array() + rounding).matrix();
  SupportShape moved{};
  moved.kind = ShapeKind::box;
  for (Eigen::Index k = 0; k < 3; ++k)
    moved.size[k] = half[k];
  moved.bounding_radius = half.stableNorm() * widened;
  Eigen::Isometry3d place = pose;
  place.translation() = pose * centre;
  return best_kernels<GjkFilter>().decide({&shape_, pose_.data()}, {&moved, place.data()}) ==
         Verdict::disjoint;
}

}  // namespace fringe::detail
