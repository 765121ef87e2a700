#include "sensing/cone_bounds.hpp"

#include <algorithm>
#include <cmath>

#include "simd/dispatch.hpp"

namespace fringe::detail {
namespace {

using Eigen::Vector3d;

/// Relative error bound of coordinates: covers the rounding within which an apex counts as on a triangle, and
/// that of a product with a pose.
constexpr double coordinate_rounding = 0x1p-48;

/// Bound, with room to spare, on how far a pose's rotation is from orthonormal (pose_from_matrix) and its
/// transpose from its inverse.
constexpr double orthonormality = 1e-8;

/// Relative margin that covers `boundary_width` and the rounding of a dozen operations.
constexpr double relative_rounding = 0x1p-46;

/// Tests whether the square is in a range where squares of components neither overflow nor lose digits.
bool is_ordinary(double square) {
  return square > 0x1p-900 && square < 0x1p900;
}

}  // namespace

ConeBounds::ConeBounds(const SensingCone& cone, const Eigen::Isometry3d& pose)
    : apex_(pose.linear().transpose() * (cone.apex - pose.translation())),
      axis_(pose.linear().transpose() * cone.direction.stableNormalized()),
      cosine_(std::max(0.0, std::cos(cone.full_angle / 2))), sine_(std::sin(cone.full_angle / 2)) {
  const bool is_identity = pose.matrix() == Eigen::Matrix4d::Identity();
  pose_rounding_ = is_identity ? coordinate_rounding : orthonormality;
  apex_allowance_ = pose_rounding_ * apex_.lpNorm<1>() +
                    coordinate_rounding * (cone.apex.lpNorm<1>() + pose.translation().lpNorm<1>());
}

double ConeBounds::allowance(const Eigen::AlignedBox3d& box) const {
  return apex_allowance_ + pose_rounding_ * box.min().cwiseAbs().cwiseMax(box.max().cwiseAbs()).sum();
}

double ConeBounds::least_distance(const Eigen::AlignedBox3d& box) const {
  const Vector3d beside = (box.min() - apex_).cwiseMax(apex_ - box.max()).cwiseMax(0);
  const double square = beside.squaredNorm();
  const double distance = is_ordinary(square) ? std::sqrt(square) : beside.maxCoeff();
  return distance * (1 - relative_rounding) - allowance(box);
}

/// Returns a lower bound of the distance from the apex to the triangle, apart from the rounding of its
/// coordinates. Along any unit vector the triangle is at least as far as its nearest vertex. The best such
/// vector points to the point nearest to the apex: it is the normal if that point is inside the triangle; if
/// it is near a vertex, the direction to that vertex is nearly as good.
double ConeBounds::least_distance(const Triangle& triangle) const {
  const Vector3d a = triangle[0] - apex_, b = triangle[1] - apex_, c = triangle[2] - apex_;
  double least = 0;
  for (const Vector3d& direction : {(b - a).cross(c - a).eval(), a, b, c}) {
    const double square = direction.squaredNorm();
    if (!is_ordinary(square))
      continue;
    const double along_a = direction.dot(a), along_b = direction.dot(b), along_c = direction.dot(c);
    const double nearest =
        std::max(std::min({along_a, along_b, along_c}), -std::max({along_a, along_b, along_c}));
    least = std::max(least, nearest / std::sqrt(square));
  }
  return least - relative_rounding * (a.lpNorm<1>() + b.lpNorm<1>() + c.lpNorm<1>());
}

/// Tests whether one of two planes through the apex separates the cone from all points: the plane
/// perpendicular to the axis, and the plane tangent to the cone along the line nearest to a centre.
/// least(direction) is the smallest product of the direction with a point.
template <class Reach>
bool ConeBounds::separated(const Vector3d& centre, const Reach& least) const {
  if (least(-axis_) > 0)
    return true;
  const Vector3d aside = centre - centre.dot(axis_) * axis_;
  const double square = aside.squaredNorm();
  if (!is_ordinary(square))
    return false;
  // Near the axis most of `aside` is rounding error; it must be made perpendicular to the axis again for the
  // plane to have the cone on its other side.
  const Vector3d across = aside / std::sqrt(square);
  return least(cosine_ * (across - across.dot(axis_) * axis_) - sine_ * axis_) > 0;
}

bool ConeBounds::misses(const Eigen::AlignedBox3d& box) const {
  const Vector3d centre = box.min() / 2 + box.max() / 2 - apex_, half = box.max() / 2 - box.min() / 2;
  const double slack = allowance(box) + relative_rounding * (centre.lpNorm<1>() + half.sum());
  return separated(centre, [&](const Vector3d& direction) {
    return direction.dot(centre) - direction.cwiseAbs().dot(half) - slack;
  });
}

bool ConeBounds::misses(const Triangle& triangle, const Eigen::AlignedBox3d& box) const {
  const Vector3d a = triangle[0] - apex_, b = triangle[1] - apex_, c = triangle[2] - apex_;
  const double slack =
      allowance(box) + relative_rounding * a.cwiseAbs().cwiseMax(b.cwiseAbs()).cwiseMax(c.cwiseAbs()).sum();
  return separated((a + b + c) / 3, [&](const Vector3d& direction) {
    return std::min({direction.dot(a), direction.dot(b), direction.dot(c)}) - slack;
  });
}

bool ConeBounds::misses(const Triangle& triangle, double reach) const {
  Eigen::AlignedBox3d box(triangle[0]);
  box.extend(triangle[1]).extend(triangle[2]);
  // The cheapest test comes first.
  return least_distance(box) > reach || misses(triangle, box) ||
         least_distance(triangle) - allowance(box) > reach;
}

namespace {

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
