#include "correction/two_surfaces.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "correction/adaptive_quadrature.hpp"
#include "integral/facing.hpp"
#include "numeric/infinity.hpp"

namespace fringe::detail {
namespace {

using Eigen::Vector3d;

/// Error of each triangle's integral, relative to its value at a distance of the triangle's own size.
constexpr double quadrature_tolerance = 1e-3;

/// Weight of the lateral distance relative to the height (no unit), fitted to the set-ups that are not
/// sealed.
constexpr double lateral_weight = 1.62;

/// A flat convex face, given by its outline.
struct FlatFace {
  std::vector<Vector3d> corners;
  Vector3d normal;
};

std::vector<FlatFace> faces_of(std::span<const Rectangle> plates) {
  std::vector<FlatFace> faces;
  for (const auto& [corner, u, v] : plates)
    faces.push_back({{corner, corner + u, corner + u + v, corner + v}, u.cross(v).normalized()});
  return faces;
}

/// Returns the faces of a surface; two consecutive triangles that form a parallelogram are one face.
std::vector<FlatFace> faces_of(const ChargedSurface& surface) {
  constexpr double rounding = 1e-9;
  std::vector<FlatFace> faces;
  const auto& triangles = surface.triangles;
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    const auto& [p, q, r] = triangles[i];
    if (i + 1 < triangles.size()) {
      const auto& [p2, r2, s] = triangles[i + 1];
      if (p2 == p && r2 == r && (p + r - q - s).norm() <= rounding * (r - p).norm()) {
        faces.push_back({{p, q, r, s}, surface.normals[i]});
        ++i;
        continue;
      }
    }
    if (!surface.normals[i].isZero())
      faces.push_back({{p, q, r}, surface.normals[i]});
  }
  return faces;
}

Vector3d nearest_on_segment(const Vector3d& a, const Vector3d& b, const Vector3d& point) {
  const double t = (point - a).dot(b - a) / (b - a).squaredNorm();
  return a + std::clamp(t, 0.0, 1.0) * (b - a);
}

/// Returns the distance of a point in a face's plane from the face; 0 inside.
double lateral_distance(const FlatFace& face, const Vector3d& point) {
  double squared = infinity;
  bool inside = true;
  for (std::size_t i = 0; i < face.corners.size(); ++i) {
    const Vector3d &a = face.corners[i], &b = face.corners[(i + 1) % face.corners.size()];
    inside = inside && (b - a).cross(point - a).dot(face.normal) >= 0;
    squared = std::min(squared, (nearest_on_segment(a, b, point) - point).squaredNorm());
  }
  return inside ? 0 : std::sqrt(squared);
}

/// Returns the distance of a point from the nearest face.
double distance(std::span<const FlatFace> faces, const Vector3d& point) {
  double least = infinity;
  for (const FlatFace& face : faces) {
    const double height = face.normal.dot(point - face.corners[0]);
    least = std::min(least, std::hypot(height, lateral_distance(face, point - height * face.normal)));
  }
  return least;
}

/// Returns the length of the arc from a point of a surface with the given normal to the nearest face.
double front_length(std::span<const FlatFace> faces, const Vector3d& point, const Vector3d& normal) {
  double least = infinity;
  for (const FlatFace& face : faces) {
    const double height = face.normal.dot(point - face.corners[0]);
    const double lateral = lateral_distance(face, point - height * face.normal);
    const double sine = normal.cross(face.normal).norm(), cosine = std::abs(normal.dot(face.normal));
    const double stretch = sine > 0 ? std::atan2(sine, cosine) / sine : 1;
    least = std::min(least, std::hypot(stretch * height, lateral_weight * lateral));
  }
  return least;
}

/// Returns the length of the shortest path from the back of a face around one of its edges to the other
/// faces: half a turn at the edge of a sheet, with the point's distance from the edge as radius, or a quarter
/// turn at the edge of a body; then an arc.
double back_length(const FlatFace& own, bool closed, std::span<const FlatFace> faces, const Vector3d& point) {
  double least = infinity;
  for (std::size_t i = 0; i < own.corners.size(); ++i) {
    const Vector3d &a = own.corners[i], &b = own.corners[(i + 1) % own.corners.size()];
    const Vector3d to_edge = nearest_on_segment(a, b, point) - point;
    const double turns = closed ? std::numbers::pi / 2 : std::numbers::pi;
    least = std::min(least, turns * to_edge.norm() +
                                front_length(faces, point + (closed ? 1 : 2) * to_edge, own.normal));
  }
  return least;
}

/// Tests whether a corner of another face is in front of this face.
bool sees(const FlatFace& face, std::span<const FlatFace> others) {
  for (const FlatFace& other : others)
    for (const Vector3d& corner : other.corners)
      if (side_of_plane(face.corners[0], face.corners[1], face.corners[2], corner) > 0)
        return true;
  return false;
}

/// Integrates a function over a face.
template <class Function>
double integral_over(const FlatFace& face, const Function& function) {
  double sum = 0;
  for (std::size_t i = 2; i < face.corners.size(); ++i) {
    const Triangle part{face.corners[0], face.corners[i - 1], face.corners[i]};
    const double area = twice_area(part) / 2;
    if (area > 0)
      sum += adaptive_integral(part, function, quadrature_tolerance * std::sqrt(area));
  }
  return sum;
}

/// Computes ∫dA (1/L_front + 1/L_back) over a surface; a face of a closed one counts with one of its terms
/// only.
double arcs_over(std::span<const FlatFace> surface, bool closed, std::span<const FlatFace> others) {
  double sum = 0;
  for (const FlatFace& face : surface)
    sum += integral_over(face, [&](const Vector3d& point) {
      const bool front = !closed || sees(face, others), back = !closed || !front;
      return (front ? 1 / front_length(others, point, face.normal) : 0) +
             (back ? 1 / back_length(face, closed, others, point) : 0);
    });
  return sum;
}

}  // namespace

double reciprocal_integral(const ChargedSurface& object, std::span<const Rectangle> plates,
                           double on_object) {
  const std::vector<FlatFace> object_faces = faces_of(object);
  double on_sensor = 0;
  for (const FlatFace& plate : faces_of(plates))
    on_sensor +=
        integral_over(plate, [&](const Vector3d& point) { return 1 / distance(object_faces, point); });
  return std::sqrt(on_object * on_sensor);
}

double two_sided_arcs(const ChargedSurface& object, std::span<const Rectangle> plates) {
  const std::vector<FlatFace> sensor_faces = faces_of(plates), object_faces = faces_of(object);
  std::vector<FlatFace> seen;
  for (const FlatFace& face : object_faces)
    if (!object.closed || sees(face, sensor_faces))
      seen.push_back(face);
  return std::sqrt(arcs_over(object_faces, object.closed, sensor_faces) *
                   arcs_over(sensor_faces, false, seen));
}

}  // namespace fringe::detail
