#include "bem/panel_pair.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <optional>
#include <utility>

#include "bem/charge_kernels.hpp"
#include "bem/panel_quadrature.hpp"
#include "bem/patch_distance.hpp"
#include "simd/dispatch.hpp"

namespace fringe::detail {
namespace {

using Eigen::Index;
using Eigen::Vector3d;

/// Distance, relative to the smaller radius, below which a point lies on a triangle, its sides or its
/// corners. It is above rounding, and an error of this size in a common point has no visible effect.
constexpr double same_point = 1e-9;

/// A triangle's plane, and which of its points are within the triangle.
class PanelPlane {
 public:
  explicit PanelPlane(const Panel& panel) : corners_(panel.corners), normal_(unit_normal(panel.corners)) {}

  double height(const Vector3d& point) const { return normal_.dot(point - corners_[0]); }

  /// Tests whether a point of the plane is in the triangle, or no farther than `near` outside it.
  bool holds(const Vector3d& point, double near) const {
    for (std::size_t side = 0; side < 3; ++side) {
      const Vector3d along = corners_[(side + 1) % 3] - corners_[side];
      if (normal_.dot(along.cross(point - corners_[side])) < -near * along.norm())
        return false;
    }
    return true;
  }

  /// Returns the fraction of the way along a segment at which it passes through the inside of the triangle;
  /// nothing if it does not.
  std::optional<double> crossing(const Vector3d& from, const Vector3d& to, double near) const {
    const double first = height(from), last = height(to);
    if (!((first > near && last < -near) || (first < -near && last > near)))
      return std::nullopt;
    const double part = first / (first - last);
    return holds(from + part * (to - from), near) ? std::optional(part) : std::nullopt;
  }

 private:
  const Triangle& corners_;
  Vector3d normal_;
};

/// Returns a point where two triangles cross, or overlap in one plane, if no corner of one lies on the
/// other's outline; nothing if they are apart.
std::optional<Vector3d> crossing_point(const Panel& a, const Panel& b, double near) {
  for (const auto& [one, other] : {std::pair(&a, &b), std::pair(&b, &a)}) {
    const PanelPlane plane(*other);
    const std::array<double, 3> heights{plane.height(one->corners[0]), plane.height(one->corners[1]),
                                        plane.height(one->corners[2])};
    const auto [low, high] = std::minmax({heights[0], heights[1], heights[2]});
    if (low > near || high < -near)
      return std::nullopt;
    for (std::size_t side = 0; side < 3; ++side) {
      const Vector3d &from = one->corners[side], &to = one->corners[(side + 1) % 3];
      if (std::abs(heights[side]) <= near && plane.holds(from, near))
        return from;
      if (const auto part = plane.crossing(from, to, near))
        return from + *part * (to - from);
    }
    if (std::max(high, -low) > near)
      continue;
    for (std::size_t side = 0; side < 3; ++side)
      for (std::size_t across = 0; across < 3; ++across) {
        const Vector3d &from = one->corners[side], &to = one->corners[(side + 1) % 3];
        const Vector3d &low_end = other->corners[across], &high_end = other->corners[(across + 1) % 3];
        const NearestParts nearest = nearest_parts(from, to, low_end, high_end);
        const Vector3d point = from + nearest.a * (to - from);
        if ((point - low_end - nearest.b * (high_end - low_end)).norm() <= near)
          return point;
      }
  }
  return std::nullopt;
}

/// Returns a point that two triangles have in common, if possible a corner; nothing if there is none.
std::optional<Vector3d> common_point(const Panel& a, const Panel& b) {
  const double near = same_point * std::min(a.radius, b.radius);
  for (const auto& [one, other] : {std::pair(&a, &b), std::pair(&b, &a)})
    for (const Vector3d& corner : one->corners)
      if (outline_distance(other->corners, corner) <= near)
        return corner;
  return crossing_point(a, b, near);
}

/// The singularities of a panel's potential along a segment: its sides, but only the ends of a side that lies
/// on the same line as the segment.
class SingularSides {
 public:
  SingularSides(const Triangle& source, const Vector3d& from, const Vector3d& to, double near)
      : source_(source) {
    const Vector3d along = (to - from).normalized();
    for (std::size_t side = 0; side < 3; ++side)
      is_collinear_[side] = along.cross(source[side] - from).norm() <= near &&
                            along.cross(source[(side + 1) % 3] - from).norm() <= near;
  }

  double distance(const Vector3d& p, const Vector3d& q) const {
    return std::min({distance(p, q, 0), distance(p, q, 1), distance(p, q, 2)});
  }

 private:
  double distance(const Vector3d& p, const Vector3d& q, std::size_t side) const {
    const Vector3d &from = source_[side], &to = source_[(side + 1) % 3];
    return is_collinear_[side] ? std::min(segment_distance(from, p, q), segment_distance(to, p, q))
                               : segment_distance(p, q, from, to);
  }

  const Triangle& source_;
  std::array<bool, 3> is_collinear_{};
};

/// Adds the interaction of two panels that touch, cross or overlap. When both triangles grow by a factor λ
/// about a common point, the integral over both grows by λ³. It is therefore a third of what their moving
/// sides contribute: the potential of each triangle along the other's sides, times the speed of the sides.
/// Where a side passes through the other triangle, the potential has a kink.
void add_touching(const Panel& a, const Panel& b, const Vector3d& common, double tolerance,
                  PotentialSums& sums, double& sum) {
  const double near = same_point * std::min(a.radius, b.radius);
  for (const auto& pair : {std::pair(&a, &b), std::pair(&b, &a)}) {
    const Panel &moving = *pair.first, &source = *pair.second;
    const PanelPlane plane(source);
    for (std::size_t side = 0; side < 3; ++side) {
      const Vector3d &from = moving.corners[side], &to = moving.corners[(side + 1) % 3];
      const double swept = (from - common).cross(to - common).norm() / moving.area;
      // Speed below which a side rests. No side moves inwards: the common point lies in the triangle or on
      // its outline.
      constexpr double none = 1e-8;
      if (swept <= none)
        continue;
      const SingularSides singular(source.corners, from, to, near);
      const auto integrate = [&](const Vector3d& begin, const Vector3d& end, double share) {
        for_each_point(
            begin, end, tolerance,
            [&](const Vector3d& p, const Vector3d& q) { return singular.distance(p, q); },
            [&](const Vector3d& point, double weight) {
              sums.add(source.corners, point, share * weight * swept / 3, sum);
            });
      };
      if (const auto part = plane.crossing(from, to, near)) {
        const Vector3d middle = from + *part * (to - from);
        integrate(from, middle, *part);
        integrate(middle, to, 1 - *part);
      } else {
        integrate(from, to, 1);
      }
    }
  }
}

void add_near(const Panel& a, const Panel& b, double tolerance, PotentialSums& sums, double& sum) {
  const Panel &outer = a.radius < b.radius ? a : b, &inner = a.radius < b.radius ? b : a;
  /// Distance over the radius beyond which a lower bound of it does: the rule of fewest points suffices.
  constexpr double far_enough = 3;
  const double safe = inner.radius + std::min(inner.radius, far_enough * outer.radius);
  const auto distance = [&](const Vector3d& point) {
    const double centres = (point - inner.centre).norm();
    return centres > safe ? centres - inner.radius : outline_distance(inner.corners, point);
  };
  const auto lay = [&](const Vector3d& point, double weight) { sums.add(inner.corners, point, weight, sum); };
  // By reference, because a copy of the lambda would copy what it captures for every pair.
  for_each_point(outer.corners, tolerance, std::ref(distance), std::ref(lay));
}

}  // namespace

PotentialSums::PotentialSums() : PotentialSums(best_kernels<ChargeKernels>().triangle_potentials) {}

PotentialSums PotentialSums::of_solid_angles() {
  return PotentialSums(best_kernels<ChargeKernels>().solid_angles);
}

void PotentialSums::add(const Triangle& source, const Vector3d& point, double weight, double& sum) {
  if (size_ == capacity)
    flush();
  for (std::size_t corner = 0; corner < 3; ++corner)
    for (std::size_t axis = 0; axis < 3; ++axis)
      components_[3 * corner + axis][size_] =
          source[corner][static_cast<Index>(axis)] - point[static_cast<Index>(axis)];
  weights_[size_] = weight;
  sums_[size_++] = &sum;
}

void PotentialSums::flush() {
  const double* components[9];
  for (std::size_t k = 0; k < 9; ++k)
    components[k] = components_[k].data();
  std::array<double, capacity> potentials{};
  kernel_(components, size_, potentials.data());
  for (std::size_t k = 0; k < size_; ++k)
    *sums_[k] += weights_[k] * potentials[k];
  size_ = 0;
}

void add_pair(const Panel& a, const Panel& b, double tolerance, PotentialSums& sums, double& sum) {
  const double radii = a.radius + b.radius;
  const std::optional<Vector3d> common =
      (a.centre - b.centre).squaredNorm() <= radii * radii ? common_point(a, b) : std::nullopt;
  if (common)
    add_touching(a, b, *common, tolerance, sums, sum);
  else
    add_near(a, b, tolerance, sums, sum);
}

double panel_self(const Panel& panel) {
  const auto& [a, b, c] = panel.corners;
  const std::array<double, 3> sides{(b - a).norm(), (c - b).norm(), (a - c).norm()};
  const double half = (sides[0] + sides[1] + sides[2]) / 2;
  double sum = 0;
  for (std::size_t k = 0; k < 3; ++k)
    // The half perimeter minus a side: by the area, because the difference loses digits for a sliver.
    sum +=
        std::log(half / std::max(half - sides[k], panel.area * panel.area / (half * half * half))) / sides[k];
  return 4 * sum / 3;
}

}  // namespace fringe::detail
