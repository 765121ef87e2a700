#include <algorithm>
#include <cmath>
#include <optional>
#include <span>

#include <fmt/format.h>

#include "fringe/error.hpp"
#include "fringe/gjk.hpp"
#include "numeric/interruption.hpp"
#include "surface/insulators.hpp"

namespace fringe::detail {
namespace {

using Eigen::AlignedBox3d;
using Eigen::Vector3d;

/// A convex part of a triangle, anticlockwise about its normal.
using Contour = std::vector<Vector3d>;

struct Plane {
  Vector3d normal;
  double offset;
  double height(const Vector3d& point) const { return normal.dot(point) - offset; }
};

/// The parts of a polygon behind a plane and before it; one of them may be empty.
struct Halves {
  Contour behind;
  Contour before;
};

/// Cuts a convex polygon. Corners within `tolerance` of the plane are on it.
Halves cut(const Contour& polygon, const Plane& plane, double tolerance) {
  Halves result;
  bool is_behind = false, is_before = false;
  for (std::size_t k = 0; k < polygon.size(); ++k) {
    const Vector3d &from = polygon[k], &to = polygon[(k + 1) % polygon.size()];
    const double start = plane.height(from), end = plane.height(to);
    is_behind = is_behind || start < -tolerance;
    is_before = is_before || start > tolerance;
    if (start <= tolerance)
      result.behind.push_back(from);
    if (start >= -tolerance)
      result.before.push_back(from);
    if ((start < -tolerance && end > tolerance) || (start > tolerance && end < -tolerance)) {
      const Vector3d crossing = from + start / (start - end) * (to - from);
      result.behind.push_back(crossing);
      result.before.push_back(crossing);
    }
  }
  if (!is_behind)
    result.behind.clear();
  if (!is_before)
    result.before.clear();
  return result;
}

/// Returns planes through the sides of a triangle at right angles to it, with normals outwards.
std::array<Plane, 3> side_planes(const Triangle& triangle, const Vector3d& normal) {
  std::array<Plane, 3> planes;
  for (std::size_t k = 0; k < 3; ++k) {
    const Vector3d outwards = (triangle[(k + 1) % 3] - triangle[k]).cross(normal).normalized();
    planes[k] = {outwards, outwards.dot(triangle[k])};
  }
  return planes;
}

/// Returns the parts of a triangle, which another triangle in its plane covers wholly or not at all.
void divide_in_plane(std::vector<Contour>& parts, const Triangle& other, const Vector3d& normal,
                     double tolerance) {
  const std::array<Plane, 3> planes = side_planes(other, normal);
  std::vector<Contour> result;
  for (const Contour& part : parts) {
    Contour rest = part;
    std::vector<Contour> outside;
    for (const Plane& plane : planes) {
      Halves halves = cut(rest, plane, tolerance);
      if (!halves.before.empty())
        outside.push_back(std::move(halves.before));
      rest = std::move(halves.behind);
      if (rest.empty())
        break;
    }
    if (rest.empty()) {
      result.push_back(part);
      continue;
    }
    result.insert(result.end(), outside.begin(), outside.end());
    result.push_back(std::move(rest));
  }
  parts = std::move(result);
}

/// Returns the triangles of convex polygons, without slivers.
void add_fans(const std::vector<Contour>& parts, double tolerance, std::vector<Triangle>& triangles) {
  for (const Contour& part : parts)
    for (std::size_t k = 1; k + 1 < part.size(); ++k) {
      const Triangle triangle{part[0], part[k], part[k + 1]};
      double longest = 0;
      for (std::size_t i = 0; i < 3; ++i)
        longest = std::max(longest, (triangle[(i + 1) % 3] - triangle[i]).norm());
      if (twice_area(triangle) > tolerance * longest)
        triangles.push_back(triangle);
    }
}

/// Divides a triangle where another body's surface meets it.
class Divider {
 public:
  Divider(std::span<const Triangle> other, double tolerance) : other_(other), tolerance_(tolerance) {
    for (const Triangle& triangle : other)
      boxes_.push_back(axis_aligned_box({&triangle, 1}));
  }

  void divide(const Triangle& triangle, std::vector<Contour>& parts) const {
    const Vector3d normal = unit_normal(triangle);
    const Plane own{normal, normal.dot(triangle[0])};
    AlignedBox3d box;
    for (const Vector3d& corner : triangle)
      box.extend(corner);
    for (std::size_t k = 0; k < other_.size(); ++k) {
      const Triangle& against = other_[k];
      if (boxes_[k].squaredExteriorDistance(box) > tolerance_ * tolerance_)
        continue;
      const Vector3d theirs = unit_normal(against);
      const Plane plane{theirs, theirs.dot(against[0])};
      if (is_on(triangle, plane) && is_on(against, own)) {
        const bool is_alike = theirs.dot(normal) > 0;
        divide_in_plane(parts, is_alike ? against : Triangle{against[0], against[2], against[1]}, normal,
                        tolerance_);
      } else if (is_on_both_sides(triangle, plane) && is_on_both_sides(against, own) &&
                 gjk_intersects(triangle, against).intersects) {
        divide_by_plane(parts, plane);
      }
    }
  }

 private:
  bool is_on(const Triangle& triangle, const Plane& plane) const {
    return std::all_of(triangle.begin(), triangle.end(),
                       [&](const Vector3d& corner) { return std::abs(plane.height(corner)) <= tolerance_; });
  }
  /// Returns true also for a triangle that ends at the plane with a side: it may divide the other one.
  bool is_on_both_sides(const Triangle& triangle, const Plane& plane) const {
    double lowest = 0, highest = 0;
    for (const Vector3d& corner : triangle) {
      lowest = std::min(lowest, plane.height(corner));
      highest = std::max(highest, plane.height(corner));
    }
    return lowest < -tolerance_ && highest > tolerance_;
  }
  void divide_by_plane(std::vector<Contour>& parts, const Plane& plane) const {
    std::vector<Contour> result;
    for (const Contour& part : parts) {
      Halves halves = cut(part, plane, tolerance_);
      for (Contour* const half : {&halves.behind, &halves.before})
        if (!half->empty())
          result.push_back(std::move(*half));
    }
    parts = std::move(result);
  }

  std::span<const Triangle> other_;
  double tolerance_;
  std::vector<AlignedBox3d> boxes_;
};

const std::string& body_name(const InsulatedBodies& bodies, std::size_t body) {
  const std::size_t conductors = bodies.conductors.bodies.size(), insulators = bodies.insulators.size();
  if (body < conductors)
    return bodies.conductors.bodies[body].name;
  return body < conductors + insulators ? bodies.insulators[body - conductors].name
                                        : bodies.films[body - conductors - insulators].name;
}

}  // namespace

std::vector<std::vector<Triangle>> divided_surfaces(const InsulatedBodies& bodies) {
  /// Largest number of parts of the surfaces that meet others.
  constexpr std::size_t most_parts = 4000;
  std::vector<std::span<const Triangle>> surfaces;
  for (const ChargedBody& body : bodies.conductors.bodies)
    surfaces.push_back(triangles_of(body.surface));
  const std::size_t conductors = surfaces.size();
  for (const Insulator& insulator : bodies.insulators)
    surfaces.emplace_back(insulator.surface);
  for (const ThinFilm& film : bodies.films)
    surfaces.emplace_back(film.sheet);
  std::vector<AlignedBox3d> boxes;
  boxes.reserve(surfaces.size());
  for (const auto& surface : surfaces)
    boxes.push_back(axis_aligned_box(surface));
  std::vector<std::vector<Triangle>> result;
  std::size_t added = 0;
  for (std::size_t body = 0; body < surfaces.size(); ++body) {
    check_interruption();
    std::vector<Divider> dividers;
    double tolerance = 0;
    for (std::size_t other = 0; other < surfaces.size(); ++other) {
      if (other == body || (body < conductors && other < conductors))
        continue;
      const double near =
          touching_surfaces * std::max(boxes[body].diagonal().norm(), boxes[other].diagonal().norm());
      if (boxes[body].squaredExteriorDistance(boxes[other]) > near * near)
        continue;
      dividers.emplace_back(surfaces[other], near);
      tolerance = std::max(tolerance, near);
    }
    std::vector<Triangle>& own = result.emplace_back();
    for (const Triangle& triangle : surfaces[body]) {
      std::vector<Contour> parts{{triangle[0], triangle[1], triangle[2]}};
      for (const Divider& divider : dividers)
        divider.divide(triangle, parts);
      if (parts.size() == 1) {
        own.push_back(triangle);
        continue;
      }
      add_fans(parts, tolerance, own);
      added += parts.size();
      if (added > most_parts)
        throw InputError(fmt::format(
            "{} and what it overlaps have too many triangles that cross: boundary elements divide them into "
            "at most {} parts",
            body_name(bodies, body), most_parts));
    }
  }
  return result;
}

}  // namespace fringe::detail
