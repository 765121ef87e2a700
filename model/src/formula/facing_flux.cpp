#include "formula/facing_flux.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "integral/kernel.hpp"

namespace fringe::detail {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

/// A convex polygon: at most a triangle or rectangle clipped by two planes and by the four or five sides of
/// another one.
template <class Point>
struct Polygon {
  std::array<Point, 16> points;
  std::size_t size = 0;

  void add(const Point& point) {
    if (size < points.size())
      points[size++] = point;
  }
};

/// Clips a polygon to the part where the height, given at each point, is not negative.
template <class Point, class Height>
Polygon<Point> clipped(const Polygon<Point>& polygon, const Height& height) {
  Polygon<Point> result;
  for (std::size_t i = 0; i < polygon.size; ++i) {
    const Point &a = polygon.points[i], &b = polygon.points[(i + 1) % polygon.size];
    const double at_a = height(a), at_b = height(b);
    if (at_a >= 0)
      result.add(a);
    if ((at_a > 0 && at_b < 0) || (at_a < 0 && at_b > 0))
      result.add(a + at_a / (at_a - at_b) * (b - a));
  }
  return result;
}

double cross(const Vector2d& a, const Vector2d& b) {
  return a.x() * b.y() - a.y() * b.x();
}

/// Returns twice the area, positive if the polygon is anticlockwise.
double twice_signed_area(const Polygon<Vector2d>& polygon) {
  double sum = 0;
  for (std::size_t i = 2; i < polygon.size; ++i)
    sum += cross(polygon.points[i - 1] - polygon.points[0], polygon.points[i] - polygon.points[0]);
  return sum;
}

/// Clips a polygon to a convex one.
Polygon<Vector2d> intersection(Polygon<Vector2d> polygon, const Polygon<Vector2d>& convex) {
  const double turn = twice_signed_area(convex) < 0 ? -1 : 1;
  for (std::size_t i = 0; i < convex.size && polygon.size > 2; ++i) {
    const Vector2d& a = convex.points[i];
    const Vector2d along = turn * (convex.points[(i + 1) % convex.size] - a);
    polygon = clipped(polygon, [&](const Vector2d& point) { return cross(along, point - a); });
  }
  return polygon;
}

/// 2·∫dλ/g and 2·∫dλ/√(g² + s²) over the simplex, where g is linear with the values g0, g1, g2 at the
/// corners.
struct InverseGaps {
  double sharp;
  double soft;
};

InverseGaps inverse_gaps(double g0, double g1, double g2, double softness) {
  const auto [least, most] = std::minmax({g0, g1, g2});
  // The error of the Taylor series about the mean is about a hundredth of the third power of the relative
  // change: 5e-5, far below the formula's own error.
  constexpr double nearly_constant = 0.15;
  if (most - least <= nearly_constant * least) {
    const double mean = (g0 + g1 + g2) / 3, squared = mean * mean;
    const double variance =
        ((g0 - mean) * (g0 - mean) + (g1 - mean) * (g1 - mean) + (g2 - mean) * (g2 - mean)) / 12;
    const double soft_squared = squared + softness * softness, soft = 1 / std::sqrt(soft_squared);
    return {(1 + variance / squared) / mean,
            soft * (1 + variance * (squared - softness * softness / 2) / (soft_squared * soft_squared))};
  }
  return {2 * kernel_of_heights(g0, g1, g2),
          2 * kernel({g0, softness, 0}, {g1, softness, 0}, {g2, softness, 0})};
}

Polygon<Vector2d> projected(const Polygon<Vector3d>& polygon, const Vector3d& axis_u,
                            const Vector3d& axis_v) {
  Polygon<Vector2d> result;
  for (std::size_t i = 0; i < polygon.size; ++i)
    result.add({axis_u.dot(polygon.points[i]), axis_v.dot(polygon.points[i])});
  return result;
}

/// A pair of facing sides and the plane that bisects the angle between them.
struct Facing {
  Vector3d across;  ///< unit vector from the plate to the triangle, normal to the bisecting plane
  double cosine;    ///< cosine of the angle between the surfaces
  double factor;    ///< factor on ∫dA/gap along `across`, which replaces the gap by the arc's length

  Facing(const Vector3d& sum_of_normals, double cosine_between)
      : across(sum_of_normals.normalized()), cosine(cosine_between) {
    // Surfaces side by side in one plane do not face each other: the weight falls to zero over the last
    // tenth.
    constexpr double nearly_opposite = 0.1;
    const double weight = std::min(1.0, (1 + cosine) / nearly_opposite);
    // The gap along `across` is a chord of the arc: gap = 2ρ sin(θ/2), projected area = cos(θ/2) dA, arc =
    // ρθ.
    const double tangent = std::sqrt(std::max(0.0, 1 - cosine) / (1 + cosine));
    constexpr double small_tangent = 1e-4;
    factor = weight * (tangent < small_tangent ? 1 : tangent / std::atan(tangent));
  }
};

/// Least value of 1 + cosine; below it neither the angle nor the bisecting plane is known.
constexpr double least_opening = 1e-7;

/// Adds the flux over a triangle of the bisecting plane, where `area` is the triangle's and the gaps are
/// those at its corners.
void add(FacingFlux& sum, const Facing& facing, double area, double gap0, double gap1, double gap2,
         double softness) {
  const auto [sharp, soft] = inverse_gaps(gap0, gap1, gap2, softness);
  const double share = facing.factor * area;
  sum.flux += share * sharp;
  sum.soft_flux += share * soft;
  sum.tilted_excess += (1 - facing.cosine) * share * (sharp - soft);
  sum.area += area * std::min(1.0, facing.factor);
}

/// The coordinates of the triangle's corners in the plate, when projected along a direction: 0 … 1 along both
/// edges.
struct Shadow {
  double u[3];
  double v[3];

  Shadow(const Triangle& triangle, const FacingPlate& plate, const Vector3d& direction) {
    const Vector3d edge_u = plate.corners[1] - plate.corners[0], edge_v = plate.corners[3] - plate.corners[0];
    const Vector3d along_u = edge_v.cross(direction), along_v = edge_u.cross(direction);
    const double scale_u = 1 / edge_u.dot(along_u), scale_v = 1 / edge_v.dot(along_v);
    for (std::size_t i = 0; i < 3; ++i) {
      const Vector3d from_corner = triangle[i] - plate.corners[0];
      u[i] = scale_u * from_corner.dot(along_u);
      v[i] = scale_v * from_corner.dot(along_v);
    }
  }

  /// Tests by intervals whether the triangle certainly projects beside the plate.
  bool misses() const {
    const auto outside = [](const double(&x)[3]) {
      return std::max({x[0], x[1], x[2]}) <= 0 || std::min({x[0], x[1], x[2]}) >= 1;
    };
    return outside(u) || outside(v);
  }

  /// Tests whether the triangle projects into the plate.
  bool within() const {
    const auto inside = [](const double(&x)[3]) {
      return std::min({x[0], x[1], x[2]}) >= 0 && std::max({x[0], x[1], x[2]}) <= 1;
    };
    return inside(u) && inside(v);
  }
};

/// Adds the flux between two sides that overlap in part, or of which one crosses the other's plane.
void add_common_part(FacingFlux& sum, const Facing& facing, const Triangle& triangle, const Vector3d& normal,
                     const FacingPlate& plate, const Vector3d& plate_normal, double softness) {
  const Vector3d &on_plate = plate.corners[0], &on_triangle = triangle[0];
  Polygon<Vector3d> seen, seeing;
  for (const Vector3d& corner : triangle)
    seen.add(corner);
  for (const Vector3d& corner : plate.corners)
    seeing.add(corner);
  seen = clipped(seen, [&](const Vector3d& point) { return plate_normal.dot(point - on_plate); });
  seeing = clipped(seeing, [&](const Vector3d& point) { return normal.dot(point - on_triangle); });
  if (seen.size < 3 || seeing.size < 3)
    return;
  // The ends of a wedge's arc are equally far from the apex of the wedge, and so they project to the same
  // point of the bisecting plane.
  const Vector3d axis_u = facing.across.unitOrthogonal(), axis_v = facing.across.cross(axis_u);
  auto common = intersection(projected(seen, axis_u, axis_v), projected(seeing, axis_u, axis_v));
  const auto height = [&](const Vector3d& on_surface, const Vector3d& of_surface, const Vector2d& place) {
    return of_surface.dot(on_surface - place.x() * axis_u - place.y() * axis_v) /
           of_surface.dot(facing.across);
  };
  const auto gap = [&](const Vector2d& place) {
    return height(on_triangle, normal, place) - height(on_plate, plate_normal, place);
  };
  common = clipped(common, gap);
  for (std::size_t i = 2; i < common.size; ++i) {
    const Vector2d &a = common.points[0], &b = common.points[i - 1], &c = common.points[i];
    const double area = std::abs(cross(b - a, c - a)) / 2;
    if (area > 0)
      add(sum, facing, area, std::max(gap(a), 0.0), std::max(gap(b), 0.0), std::max(gap(c), 0.0), softness);
  }
}

/// Adds the flux between one side of a triangle and one side of a plate, whose normals are given.
/// `whole_plate_before` tells whether the whole plate is in front of the triangle's side.
void add_sides(FacingFlux& sum, const Triangle& triangle, const Vector3d& normal, double triangle_area,
               bool whole_plate_before, const FacingPlate& plate, const Vector3d& plate_normal,
               double softness) {
  const double cosine = -normal.dot(plate_normal);
  if (1 + cosine < least_opening)
    return;
  double heights[3];
  for (std::size_t i = 0; i < 3; ++i)
    heights[i] = plate_normal.dot(triangle[i] - plate.corners[0]);
  // Nothing needs clipping if the triangle is in front of the plate's side and the plate in front of the
  // triangle's.
  const bool uncut = std::min({heights[0], heights[1], heights[2]}) > 0 && whole_plate_before;
  const Vector3d direction = plate_normal - normal;
  const Shadow shadow(triangle, plate, direction);
  if (uncut && shadow.misses())
    return;
  const Facing facing(direction, cosine);
  if (!uncut || !shadow.within()) {
    add_common_part(sum, facing, triangle, normal, plate, plate_normal, softness);
    return;
  }
  const double rise = plate_normal.dot(facing.across);
  const double area = triangle_area * std::abs(normal.dot(facing.across));
  add(sum, facing, area, heights[0] / rise, heights[1] / rise, heights[2] / rise, softness);
}

}  // namespace

FacingPlate::FacingPlate(const Rectangle& plate)
    : corners{plate.corner, plate.corner + plate.edge_u, plate.corner + plate.edge_u + plate.edge_v,
              plate.corner + plate.edge_v},
      normal(plate.edge_u.cross(plate.edge_v).stableNormalized()) {}

void add_facing_flux(FacingFlux& sum, const Triangle& triangle, const Vector3d& normal, double area,
                     bool one_sided, const FacingPlate& plate, double softness) {
  if (normal.isZero())
    return;
  double lowest = 0, highest = 0;
  for (const Vector3d& corner : plate.corners) {
    const double height = normal.dot(corner - triangle[0]);
    lowest = std::min(lowest, height);
    highest = std::max(highest, height);
  }
  const bool outside = highest > 0, inside = !one_sided && lowest < 0;
  if (!outside && !inside)
    return;
  for (const double side : {1.0, -1.0}) {
    const Vector3d plate_normal = side * plate.normal;
    if (plate_normal.dot(triangle[0] - plate.corners[0]) <= 0 &&
        plate_normal.dot(triangle[1] - plate.corners[0]) <= 0 &&
        plate_normal.dot(triangle[2] - plate.corners[0]) <= 0)
      continue;
    if (outside)
      add_sides(sum, triangle, normal, area, lowest == 0, plate, plate_normal, softness);
    if (inside)
      add_sides(sum, triangle, -normal, area, highest == 0, plate, plate_normal, softness);
  }
}

}  // namespace fringe::detail
