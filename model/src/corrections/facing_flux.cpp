#include "facing_flux.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "../kernel.hpp"

namespace fringe::detail {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

/// A convex polygon: at most a triangle or rectangle cut by two planes and the four or five sides of another.
template <class Point>
struct Polygon {
  std::array<Point, 16> points;
  std::size_t size = 0;

  void add(const Point& point) {
    if (size < points.size())
      points[size++] = point;
  }
};

/// The part of a polygon where the heights, one for each of its points, are not negative.
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

double twice_signed_area(const Polygon<Vector2d>& polygon) {
  double sum = 0;
  for (std::size_t i = 2; i < polygon.size; ++i)
    sum += cross(polygon.points[i - 1] - polygon.points[0], polygon.points[i] - polygon.points[0]);
  return sum;
}

/// The part of a polygon that lies in a convex one.
Polygon<Vector2d> intersection(Polygon<Vector2d> polygon, const Polygon<Vector2d>& convex) {
  const double turn = twice_signed_area(convex) < 0 ? -1 : 1;
  for (std::size_t i = 0; i < convex.size && polygon.size > 2; ++i) {
    const Vector2d& a = convex.points[i];
    const Vector2d along = turn * (convex.points[(i + 1) % convex.size] - a);
    polygon = clipped(polygon, [&](const Vector2d& point) { return cross(along, point - a); });
  }
  return polygon;
}

/// 2·∫dλ/g and 2·∫dλ/√(g² + s²) over the simplex, g linear with values g0, g1, g2 at the corners.
struct InverseGaps {
  double sharp;
  double soft;
};

InverseGaps inverse_gaps(double g0, double g1, double g2, double softness) {
  const auto [least, most] = std::minmax({g0, g1, g2});
  // A rule of degree 2 is off by the third power of the relative change, 1e-7.
  constexpr double nearly_constant = 0.01;
  if (most - least <= nearly_constant * least) {
    InverseGaps sum{0, 0};
    for (const double gap : {(g0 + g1) / 2, (g1 + g2) / 2, (g2 + g0) / 2}) {
      sum.sharp += 1 / (3 * gap);
      sum.soft += 1 / (3 * std::sqrt(gap * gap + softness * softness));
    }
    return sum;
  }
  return {2 * kernel_of_heights(g0, g1, g2),
          2 * kernel({g0, softness, 0}, {g1, softness, 0}, {g2, softness, 0})};
}

/// The four corners in order.
Polygon<Vector3d> outline(const Rectangle& plate) {
  Polygon<Vector3d> polygon;
  polygon.add(plate.corner);
  polygon.add(plate.corner + plate.edge_u);
  polygon.add(plate.corner + plate.edge_u + plate.edge_v);
  polygon.add(plate.corner + plate.edge_v);
  return polygon;
}

Polygon<Vector2d> projected(const Polygon<Vector3d>& polygon, const Vector3d& axis_u,
                            const Vector3d& axis_v) {
  Polygon<Vector2d> result;
  for (std::size_t i = 0; i < polygon.size; ++i)
    result.add({axis_u.dot(polygon.points[i]), axis_v.dot(polygon.points[i])});
  return result;
}

/// One side of a triangle before one side of a plate: the normals are those of the sides.
void add_sides(FacingFlux& sum, const Polygon<Vector3d>& triangle, const Vector3d& normal,
               const Polygon<Vector3d>& plate, const Vector3d& plate_normal, double softness) {
  const double cosine = -normal.dot(plate_normal);
  // Surfaces side by side in one plane face nothing: the weight falls to zero over the last tenth.
  constexpr double nearly_opposite = 0.1;
  const double weight = std::min(1.0, (1 + cosine) / nearly_opposite);
  if (weight < 1e-6)
    return;
  const Vector3d &on_plate = plate.points[0], &on_triangle = triangle.points[0];
  const auto seen = clipped(
      triangle, [&](const Vector3d& point) { return plate_normal.dot(point - on_plate); });
  if (seen.size < 3)
    return;
  const auto seeing =
      clipped(plate, [&](const Vector3d& point) { return normal.dot(point - on_triangle); });
  if (seeing.size < 3)
    return;
  // Arcs of a wedge have their ends equally far from its apex, and so in one place of the bisecting plane.
  const Vector3d across = (plate_normal - normal).normalized();
  const Vector3d axis_u = across.unitOrthogonal(), axis_v = across.cross(axis_u);
  auto common = intersection(projected(seen, axis_u, axis_v), projected(seeing, axis_u, axis_v));
  const auto height = [&](const Vector3d& on_surface, const Vector3d& of_surface, const Vector2d& place) {
    return of_surface.dot(on_surface - place.x() * axis_u - place.y() * axis_v) / of_surface.dot(across);
  };
  const auto gap = [&](const Vector2d& place) {
    return height(on_triangle, normal, place) - height(on_plate, plate_normal, place);
  };
  common = clipped(common, gap);
  const double sine = normal.cross(plate_normal).norm(), angle = std::atan2(sine, cosine);
  // The gap across is a chord of the arc: gap = 2ρ sin(θ/2), dA across = cos(θ/2) dA, arc = ρθ.
  constexpr double small_angle = 1e-4;
  const double factor =
      weight * (angle < small_angle ? 1 : 2 * sine / ((1 + cosine) * angle));
  for (std::size_t i = 2; i < common.size; ++i) {
    const Vector2d &a = common.points[0], &b = common.points[i - 1], &c = common.points[i];
    const double area = std::abs(cross(b - a, c - a)) / 2;
    if (area == 0)
      continue;
    const auto [sharp, soft] =
        inverse_gaps(std::max(gap(a), 0.0), std::max(gap(b), 0.0), std::max(gap(c), 0.0), softness);
    sum.flux += factor * area * sharp;
    sum.soft_flux += factor * area * soft;
    sum.tilted_excess += (1 - cosine) * factor * area * (sharp - soft);
    sum.area += weight * area;
  }
}

}  // namespace

void add_facing_flux(FacingFlux& sum, const Triangle& triangle, const Vector3d& normal, bool one_sided,
                     const Rectangle& plate, double softness) {
  if (normal.isZero())
    return;
  Polygon<Vector3d> corners;
  for (const Vector3d& corner : triangle)
    corners.add(corner);
  const Polygon<Vector3d> plate_corners = outline(plate);
  const Vector3d plate_normal = plate.edge_u.cross(plate.edge_v).stableNormalized();
  for (const double plate_side : {1.0, -1.0}) {
    const double highest = std::max({plate_side * plate_normal.dot(triangle[0] - plate.corner),
                                     plate_side * plate_normal.dot(triangle[1] - plate.corner),
                                     plate_side * plate_normal.dot(triangle[2] - plate.corner)});
    if (highest <= 0)
      continue;
    add_sides(sum, corners, normal, plate_corners, plate_side * plate_normal, softness);
    if (!one_sided)
      add_sides(sum, corners, -normal, plate_corners, plate_side * plate_normal, softness);
  }
}

}  // namespace fringe::detail
