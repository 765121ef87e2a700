#include "sensing/cone_bounds.hpp"

#include <algorithm>
#include <cmath>

namespace fringe::detail {
namespace {

using Eigen::Vector3d;

/// Covers the rounding of the coordinates that an apex on a triangle is granted, and that of a pose's
/// product.
constexpr double coordinate_rounding = 0x1p-48;

/// A pose's rotation may be this far from orthonormal (pose_from_matrix), its inverse as far from that; with
/// room to spare.
constexpr double orthonormality = 1e-8;

/// Covers what a cone's boundary is widened by and the rounding of a dozen operations.
constexpr double relative_rounding = 0x1p-46;

/// Squares of components within these bounds neither overflow nor lose digits.
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

/// But for the rounding of its coordinates: along any direction of length 1 the triangle is no nearer than
/// its nearest vertex is along it. The best of these directions leads to the point nearest to the apex: the
/// normal does where that is inside, and near it the directions of the vertices do.
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

/// Whether one of two planes through the apex has the cone on its one side and all points on the other: that
/// across the axis, and that which touches the cone along the line nearest to a centre. `least` is the lowest
/// product of a direction with the points.
template <class Reach>
bool ConeBounds::separated(const Vector3d& centre, const Reach& least) const {
  if (least(-axis_) > 0)
    return true;
  const Vector3d aside = centre - centre.dot(axis_) * axis_;
  const double square = aside.squaredNorm();
  if (!is_ordinary(square))
    return false;
  // Near the axis most of `aside` is rounding: only made perpendicular again it is sure to be on the cone's
  // other side.
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
  // The cheapest first.
  return least_distance(box) > reach || misses(triangle, box) ||
         least_distance(triangle) - allowance(box) > reach;
}

}  // namespace fringe::detail
