#include "fringe/triangulation.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <optional>
#include <utility>

#include "geometry/polygon.hpp"

namespace fringe {
namespace {

using Eigen::Vector3d;

constexpr double pi = std::numbers::pi;

/// Adds the quad p q r s, anticlockwise seen from outside, as (p q r) and (p r s).
void add_quad(std::vector<Triangle>& triangles, const Vector3d& p, const Vector3d& q, const Vector3d& r,
              const Vector3d& s) {
  triangles.push_back({p, q, r});
  triangles.push_back({p, r, s});
}

/// Returns the point at an angle on a circle about the z axis.
Vector3d on_circle(double radius, double angle, double z) {
  return {radius * std::cos(angle), radius * std::sin(angle), z};
}

/// Returns the k-th of n equally spaced points on a circle about the z axis; the n-th is bit-identical to the
/// first.
Vector3d on_circle(double radius, int k, int n, double z) {
  return on_circle(radius, 2 * pi * (k % n) / n, z);
}

std::vector<Triangle> triangles_of(const Plate& plate) {
  const double x = plate.size_x / 2, y = plate.size_y / 2;
  std::vector<Triangle> triangles;
  add_quad(triangles, {-x, -y, 0}, {x, -y, 0}, {x, y, 0}, {-x, y, 0});
  return triangles;
}

std::vector<Triangle> triangles_of(const Cuboid& cuboid) {
  std::array<Vector3d, 8> vertices;
  for (int i = 0; i < 8; ++i)
    vertices[i] = {(i & 1 ? 0.5 : -0.5) * cuboid.size_x, (i & 2 ? 0.5 : -0.5) * cuboid.size_y,
                   (i & 4 ? 0.5 : -0.5) * cuboid.size_z};
  constexpr std::array<std::array<int, 4>, 6> faces{
      {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}}};
  std::vector<Triangle> triangles;
  for (const auto& [p, q, r, s] : faces)
    add_quad(triangles, vertices[p], vertices[q], vertices[r], vertices[s]);
  return triangles;
}

std::vector<Triangle> triangles_of(const Cylinder& cylinder) {
  const double bottom = -cylinder.height / 2, top = cylinder.height / 2;
  std::vector<Triangle> triangles;
  for (int k = 0; k < cylinder.segments; ++k) {
    const Vector3d bottom_here = on_circle(cylinder.radius, k, cylinder.segments, bottom);
    const Vector3d bottom_next = on_circle(cylinder.radius, k + 1, cylinder.segments, bottom);
    const Vector3d top_here{bottom_here.x(), bottom_here.y(), top},
        top_next{bottom_next.x(), bottom_next.y(), top};
    add_quad(triangles, bottom_here, bottom_next, top_next, top_here);
    triangles.push_back({Vector3d(0, 0, bottom), bottom_next, bottom_here});
    triangles.push_back({Vector3d(0, 0, top), top_here, top_next});
  }
  return triangles;
}

std::vector<Triangle> triangles_of(const Cone& cone) {
  const double base = -cone.height / 2;
  std::vector<Triangle> triangles;
  for (int k = 0; k < cone.segments; ++k) {
    const Vector3d here = on_circle(cone.radius, k, cone.segments, base);
    const Vector3d next = on_circle(cone.radius, k + 1, cone.segments, base);
    triangles.push_back({here, next, Vector3d(0, 0, cone.height / 2)});
    triangles.push_back({Vector3d(0, 0, base), next, here});
  }
  return triangles;
}

std::vector<Triangle> triangles_of(const Arc& arc) {
  const bool full_ring = arc.degrees == 360;
  struct Ring {
    Vector3d inner_bottom, outer_bottom, inner_top, outer_top;
  };
  const auto ring = [&](int k) {
    // At 360 degrees the last ring is bit-identical to the first.
    const double fraction = static_cast<double>(full_ring ? k % arc.segments : k) / arc.segments - 0.5;
    const double angle = arc.degrees * fraction * pi / 180;
    const double bottom = -arc.height / 2, top = arc.height / 2;
    return Ring{on_circle(arc.inner_radius, angle, bottom), on_circle(arc.outer_radius, angle, bottom),
                on_circle(arc.inner_radius, angle, top), on_circle(arc.outer_radius, angle, top)};
  };
  std::vector<Triangle> triangles;
  for (int k = 0; k < arc.segments; ++k) {
    const Ring a = ring(k), b = ring(k + 1);
    add_quad(triangles, a.outer_bottom, b.outer_bottom, b.outer_top, a.outer_top);
    add_quad(triangles, b.inner_bottom, a.inner_bottom, a.inner_top, b.inner_top);
    add_quad(triangles, a.inner_bottom, b.inner_bottom, b.outer_bottom, a.outer_bottom);
    add_quad(triangles, a.inner_top, a.outer_top, b.outer_top, b.inner_top);
  }
  if (!full_ring) {
    const Ring first = ring(0), last = ring(arc.segments);
    add_quad(triangles, first.inner_bottom, first.outer_bottom, first.outer_top, first.inner_top);
    add_quad(triangles, last.outer_bottom, last.inner_bottom, last.inner_top, last.outer_top);
  }
  return triangles;
}

std::vector<Triangle> triangles_of_ball(double radius, int n) {
  const int bands = std::max(2, n / 2);
  const auto point = [&](int j, int k) {
    const double polar = pi * j / bands;
    return on_circle(radius * std::sin(polar), k, n, radius * std::cos(polar));
  };
  const Vector3d north(0, 0, radius), south(0, 0, -radius);
  std::vector<Triangle> triangles;
  triangles.reserve(2 * static_cast<std::size_t>(n) * static_cast<std::size_t>(bands - 1));
  for (int k = 0; k < n; ++k)
    triangles.push_back({north, point(1, k), point(1, k + 1)});
  for (int j = 1; j <= bands - 2; ++j)
    for (int k = 0; k < n; ++k)
      add_quad(triangles, point(j, k), point(j + 1, k), point(j + 1, k + 1), point(j, k + 1));
  for (int k = 0; k < n; ++k)
    triangles.push_back({south, point(bands - 1, k + 1), point(bands - 1, k)});
  return triangles;
}

std::vector<Triangle> triangles_of(const Sphere& sphere) {
  return triangles_of_ball(sphere.radius, sphere.segments);
}

std::vector<Triangle> triangles_of(const Ellipsoid& ellipsoid) {
  const Vector3d semi_axes(ellipsoid.semi_axis_x, ellipsoid.semi_axis_y, ellipsoid.semi_axis_z);
  std::vector<Triangle> triangles = triangles_of_ball(1, ellipsoid.segments);
  for (Triangle& triangle : triangles)
    for (Vector3d& vertex : triangle)
      vertex = vertex.cwiseProduct(semi_axes);
  return triangles;
}

/// The grid of points of a box swept by a ball: a row has one polar angle, a column one azimuth, and each
/// octant of the ball stands at a corner of the box.
class SweptGrid {
 public:
  SweptGrid(Vector3d core, double radius, int quarter)
      : core_(std::move(core)), radius_(radius), quarter_(quarter) {
    for (int k = 0; k < quarter; ++k)
      cosines_.push_back(std::cos(pi / 2 * k / quarter));
    cosines_.push_back(0);
  }

  int rows() const { return 2 * quarter_ + 2; }
  int columns() const { return 4 * quarter_ + 4; }
  int quarter() const { return quarter_; }

  /// Returns half the side of the box between a column and the next one; nothing within a quadrant.
  std::optional<double> side_after(int column) const {
    if (column % (quarter_ + 1) != quarter_)
      return std::nullopt;
    return core_[column / (quarter_ + 1) % 2];
  }

  Vector3d point(int row, int column) const {
    const bool upper = row <= quarter_;
    const int i = row % (quarter_ + 1), j = column % columns() % (quarter_ + 1);
    const double along = upper ? sine(i) : cosine(i), beside = upper ? cosine(i) : -sine(i);
    const double c = cosine(j), s = sine(j);
    const double x = core_.x(), y = core_.y(), z = upper ? core_.z() : -core_.z();
    const double height = z + radius_ * beside;
    switch (column % columns() / (quarter_ + 1)) {
    case 0:
      return placed(x, y, along, c, s, height);
    case 1:
      return placed(-x, y, along, -s, c, height);
    case 2:
      return placed(-x, -y, along, -c, -s, height);
    default:
      return placed(x, -y, along, s, -c, height);
    }
  }

 private:
  double cosine(int k) const { return cosines_[static_cast<std::size_t>(k)]; }
  double sine(int k) const { return cosine(quarter_ - k); }

  /// Adding 0 turns −0 into 0, so that equal corners have equal bits.
  Vector3d placed(double x, double y, double along, double c, double s, double height) const {
    return {x + radius_ * along * c + 0.0, y + radius_ * along * s + 0.0, height + 0.0};
  }

  Vector3d core_;
  double radius_;
  int quarter_;  ///< number of pieces of a quarter of the circle
  std::vector<double> cosines_;
};

/// Triangulates a box swept by a ball. Triangles without area are left out: those at the poles of the octants
/// and across sides of the box without length.
std::vector<Triangle> triangles_of_swept(const Vector3d& core, double radius, int segments) {
  const SweptGrid grid(core, radius, std::max(1, segments / 4));
  const int q = grid.quarter(), last = grid.rows() - 1;
  const bool has_caps = core.x() > 0 && core.y() > 0;
  std::vector<Triangle> triangles;
  if (has_caps)
    add_quad(triangles, grid.point(0, 0), grid.point(0, q + 1), grid.point(0, 2 * q + 2),
             grid.point(0, 3 * q + 3));
  for (int i = 0; i < last; ++i) {
    if (i == q && core.z() == 0)
      continue;
    for (int j = 0; j < grid.columns(); ++j) {
      const std::optional<double> side = grid.side_after(j);
      if (side && *side == 0)
        continue;
      const Vector3d here = grid.point(i, j), below = grid.point(i + 1, j),
                     next_below = grid.point(i + 1, j + 1), next = grid.point(i, j + 1);
      if (side || i < last - 1)
        triangles.push_back({here, below, next_below});
      if (side || i > 0)
        triangles.push_back({here, next_below, next});
    }
  }
  if (has_caps) {
    triangles.push_back({grid.point(last, 0), grid.point(last, 2 * q + 2), grid.point(last, q + 1)});
    triangles.push_back({grid.point(last, 0), grid.point(last, 3 * q + 3), grid.point(last, 2 * q + 2)});
  }
  return triangles;
}

std::vector<Triangle> triangles_of(const Capsule& capsule) {
  return triangles_of_swept(core_of(capsule), capsule.radius, capsule.segments);
}

std::vector<Triangle> triangles_of(const RoundedCuboid& cuboid) {
  return triangles_of_swept(core_of(cuboid), cuboid.rounding, cuboid.segments);
}

std::vector<Triangle> triangles_of(const Disc& disc) {
  std::vector<Triangle> triangles;
  triangles.reserve(static_cast<std::size_t>(disc.segments));
  for (int k = 0; k < disc.segments; ++k)
    triangles.push_back({Vector3d(0, 0, 0), on_circle(disc.radius, k, disc.segments, 0),
                         on_circle(disc.radius, k + 1, disc.segments, 0)});
  return triangles;
}

std::vector<Triangle> triangles_of(const Polygon& polygon) {
  return detail::triangles_of_polygon(polygon.vertices);
}

std::vector<Triangle> triangles_of(const Mesh& mesh) {
  return mesh.triangles;
}

}  // namespace

std::vector<Triangle> triangulate(const Shape& shape) {
  return std::visit([](const auto& form) { return triangles_of(form); }, shape);
}

}  // namespace fringe
