#include "collision/bounding_volume.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include <Eigen/Geometry>

namespace fringe::detail {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;
using Points = std::vector<Vector3d>;

struct BoxCandidate {
  Matrix3d axes;
  double volume;
};

/// Returns directions spread evenly over a half sphere, along a spiral.
std::vector<Vector3d> spread_directions(std::size_t count) {
  constexpr double golden_angle = std::numbers::pi * (3 - 2.23606797749978969);
  std::vector<Vector3d> directions;
  directions.reserve(count);
  for (std::size_t i = 0; i < count; ++i) {
    const double z = (static_cast<double>(i) + 0.5) / static_cast<double>(count);
    const double angle = golden_angle * static_cast<double>(i), radius = std::sqrt(1 - z * z);
    directions.emplace_back(radius * std::cos(angle), radius * std::sin(angle), z);
  }
  return directions;
}

/// Returns the points that are extreme along at least one of many directions: few points whose hull is nearly
/// that of all.
Points extreme_points(const Points& points) {
  constexpr std::size_t few = 100;              ///< vertices up to which all are kept
  constexpr std::size_t direction_count = 400;  ///< number of directions
  if (points.size() <= few)
    return points;
  std::vector<std::size_t> indices;
  for (const Vector3d& direction : spread_directions(direction_count)) {
    const auto less = [&](const Vector3d& p, const Vector3d& q) {
      return p.dot(direction) < q.dot(direction);
    };
    const auto [lowest, highest] = std::minmax_element(points.begin(), points.end(), less);
    indices.push_back(static_cast<std::size_t>(lowest - points.begin()));
    indices.push_back(static_cast<std::size_t>(highest - points.begin()));
  }
  std::sort(indices.begin(), indices.end());
  indices.erase(std::unique(indices.begin(), indices.end()), indices.end());
  Points extreme;
  extreme.reserve(indices.size());
  for (const std::size_t index : indices)
    extreme.push_back(points[index]);
  return extreme;
}

/// Returns twice the signed area of the triangle abc, positive if its corners are anticlockwise.
double turn(const Vector2d& a, const Vector2d& b, const Vector2d& c) {
  return (b.x() - a.x()) * (c.y() - a.y()) - (b.y() - a.y()) * (c.x() - a.x());
}

/// Computes the corners of the convex hull, anticlockwise, by Andrew's monotone chain. Rounding may omit a
/// corner that is close to an edge; this does no harm, since the box is fitted to all points at the end.
std::vector<Vector2d> convex_hull(std::vector<Vector2d> points) {
  std::sort(points.begin(), points.end(), [](const Vector2d& p, const Vector2d& q) {
    return p.x() < q.x() || (p.x() == q.x() && p.y() < q.y());
  });
  std::vector<Vector2d> hull;
  const auto extend = [&](const Vector2d& point, std::size_t keep) {
    while (hull.size() >= keep + 2 && turn(hull[hull.size() - 2], hull.back(), point) <= 0)
      hull.pop_back();
    hull.push_back(point);
  };
  for (const Vector2d& point : points)
    extend(point, 0);
  const std::size_t lower = hull.size() - 1;
  for (std::size_t i = points.size() - 1; i-- > 0;)
    extend(points[i], lower);
  if (hull.size() > 1)
    hull.pop_back();
  return hull;
}

/// Returns the extent of the points along an axis.
template <class Vectors, class Vector>
double width_along(const Vectors& points, const Vector& axis) {
  double lowest = std::numeric_limits<double>::infinity(), highest = -lowest;
  for (const auto& point : points) {
    const double height = point.dot(axis);
    lowest = std::min(lowest, height);
    highest = std::max(highest, height);
  }
  return highest - lowest;
}

/// Finds the smallest box with a given first axis: the smallest rectangle around a polygon has a side along
/// one of the polygon's edges (H. Freeman and R. Shapira, Communications of the ACM 18, 1975, 409).
BoxCandidate smallest_with_axis(const Points& points, const Vector3d& axis) {
  // Added to every width (for coordinates of the order of one; far above rounding). All boxes around a flat
  // shape have volume zero; with this, the one of the smallest area or length is chosen.
  constexpr double least_width = 1e-12;
  const Vector3d u = axis.unitOrthogonal(), v = axis.cross(u);
  std::vector<Vector2d> projected;
  projected.reserve(points.size());
  for (const Vector3d& point : points)
    projected.emplace_back(point.dot(u), point.dot(v));
  const std::vector<Vector2d> hull = convex_hull(std::move(projected));
  double best = std::numeric_limits<double>::infinity();
  Vector2d best_side = Vector2d::UnitX();
  for (std::size_t i = 0; i < hull.size(); ++i) {
    const Vector2d edge = hull[(i + 1) % hull.size()] - hull[i];
    const Vector2d side = edge.norm() > 0 ? Vector2d(edge.normalized()) : Vector2d(Vector2d::UnitX());
    const double area = (width_along(hull, side) + least_width) *
                        (width_along(hull, Vector2d(-side.y(), side.x())) + least_width);
    if (area < best) {
      best = area;
      best_side = side;
    }
  }
  BoxCandidate candidate;
  candidate.axes.row(0) = axis;
  candidate.axes.row(1) = best_side.x() * u + best_side.y() * v;
  candidate.axes.row(2) = best_side.x() * v - best_side.y() * u;
  candidate.volume = best * (width_along(points, axis) + least_width);
  return candidate;
}

/// Improves a box: keeps one axis and turns the other two to the smallest box, for each axis in turn, until a
/// round reduces the volume no further.
BoxCandidate improved(const Points& points, BoxCandidate candidate) {
  constexpr double worth_a_round = 1 - 1e-9;  ///< ratio of volumes above which a round is the last
  while (true) {
    const double before = candidate.volume;
    const Matrix3d axes = candidate.axes;
    for (Eigen::Index i = 0; i < 3; ++i) {
      const BoxCandidate turned = smallest_with_axis(points, axes.row(i).transpose().normalized());
      if (turned.volume < candidate.volume)
        candidate = turned;
    }
    if (!(candidate.volume < before * worth_a_round))
      return candidate;
  }
}

void append_axes(std::vector<Vector3d>& directions, const Matrix3d& axes) {
  for (Eigen::Index i = 0; i < 3; ++i)
    directions.emplace_back(axes.row(i).transpose().normalized());
}

/// Appends the normals of the largest faces, since a tight box often lies flat on one of them.
void append_normals(std::vector<Vector3d>& directions, const Points& points, std::span<const Face> faces) {
  constexpr std::size_t most = 60;  ///< number of normals
  std::vector<Vector3d> normals;
  for (const auto& [i, j, k] : faces) {
    const Vector3d normal = (points[j] - points[i]).cross(points[k] - points[i]);
    if (normal.norm() > 0)
      normals.push_back(normal);
  }
  const auto count = static_cast<std::ptrdiff_t>(std::min(most, normals.size()));
  std::partial_sort(normals.begin(), normals.begin() + count, normals.end(),
                    [](const Vector3d& p, const Vector3d& q) { return p.squaredNorm() > q.squaredNorm(); });
  for (std::ptrdiff_t i = 0; i < count; ++i)
    directions.emplace_back(normals[static_cast<std::size_t>(i)].normalized());
}

/// For a shape of few vertices, appends the directions of all lines through two vertices, the edges among
/// them.
void append_connections(std::vector<Vector3d>& directions, const Points& points) {
  constexpr std::size_t few = 16;  ///< vertices up to which all pairs are used
  if (points.size() > few)
    return;
  for (std::size_t i = 0; i < points.size(); ++i)
    for (std::size_t j = 0; j < i; ++j)
      if (points[i] != points[j])
        directions.emplace_back((points[i] - points[j]).normalized());
}

}  // namespace

Matrix3d tight_axes(const Points& points, std::span<const Face> faces) {
  constexpr std::size_t spread = 100;  ///< number of directions spread over the half sphere
  // Number of starting boxes that are improved; the smallest box is reached from one of them.
  constexpr std::size_t improved_count = 12;
  const Points extreme = extreme_points(points);
  // The candidates for the first axis of a box.
  std::vector<Vector3d> directions = spread_directions(spread);
  append_axes(directions, Matrix3d::Identity());
  append_axes(directions, axes_of_vertices(points));
  append_axes(directions, axes_of_triangles(points, faces));
  append_normals(directions, points, faces);
  append_connections(directions, extreme);
  std::vector<BoxCandidate> candidates;
  candidates.reserve(directions.size());
  for (const Vector3d& direction : directions)
    candidates.push_back(smallest_with_axis(extreme, direction));
  const auto smaller = [](const BoxCandidate& p, const BoxCandidate& q) { return p.volume < q.volume; };
  std::sort(candidates.begin(), candidates.end(), smaller);
  candidates.resize(std::min(improved_count, candidates.size()));
  for (BoxCandidate& candidate : candidates)
    candidate = improved(extreme, candidate);
  return std::min_element(candidates.begin(), candidates.end(), smaller)->axes;
}

}  // namespace fringe::detail
