#include "collision/round_search.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "collision/convex_shape_data.hpp"
#include "collision/exact_search.hpp"
#include "simd/dispatch.hpp"

namespace fringe::detail {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

/// Returns an inner point of the shape, towards which points of its round surface are moved.
Vector3d inner_point(const SupportShape& shape) {
  if (shape.form != Form::sector)
    return Vector3d::Zero();
  return {(shape.size[0] + shape.size[2] * shape.ends[0]) / 2, 0, 0};
}

/// Returns the fraction of the way to inner_point by which a rounded surface point is moved inwards so that
/// it certainly lies in the shape.
double inward_share(const SupportShape& shape) {
  constexpr double share = 0x1p-48;
  if (shape.form != Form::sector || shape.size[0] == 0)
    return share;
  // The inner point of a thin piece is close to its flat sides, so the fraction must be larger.
  const double thickness = (shape.size[0] - shape.size[2] * shape.ends[0]) / shape.size[0];
  return std::min(1.0, share / std::min(thickness, shape.ends[3]));
}

/// The support points of a shape found so far, in its frame, and their positions.
struct FoundPoints {
  const ConvexShape& shape;
  const Isometry3d& pose;
  Vector3d offset;  ///< from the rotated points to their positions relative to B's origin
  std::vector<Vector3d> points;
  std::vector<Vector3d> positions;

  bool is_round() const { return shape.is_round(); }

  /// Adds a support point, moved inwards if the shape is round; returns its index.
  std::size_t add(const Vector3d& point) {
    const SupportShape& support = shape.data().support;
    const Vector3d within =
        is_round() ? Vector3d(point + inward_share(support) * (inner_point(support) - point)) : point;
    points.push_back(within);
    positions.emplace_back(pose.linear() * within + offset);
    return points.size() - 1;
  }

  Vector3d farthest_along(const Vector3d& direction) const {
    const Vector3d local = pose.linear().transpose() * direction;
    Vector3d point;
    best_kernels<GjkFilter>().support(shape.data().support, local.data(), point.data());
    return point;
  }
};

/// Converts a simplex of indices to the points in the shapes' frames.
PointSimplex simplex_of(const PairSimplex& pairs, const FoundPoints& a, const FoundPoints& b) {
  PointSimplex simplex;
  for (std::size_t i = 0; i < pairs.size; ++i)
    simplex.pairs[simplex.size++] = {a.points[pairs.pairs[i].a], b.points[pairs.pairs[i].b]};
  return simplex;
}

/// Finds, in integers, the distance of the hulls of the points found so far, and the simplex nearest to the
/// origin.
ExactNearest nearest_of(const HullPair& hulls, const FoundPoints& a, const FoundPoints& b,
                        const PairSimplex& start, double& distance) {
  const ExactHulls exact =
      exact_hulls(hulls, ExactVertices(a.points, a.pose), ExactVertices(b.points, b.pose));
  ExactNearest nearest = exact_search(exact, start, Goal::distance);
  distance = rounded_root_quotient(dot(nearest.point, nearest.point), nearest.total, exact.unit);
  return nearest;
}

}  // namespace

ShapeAnswer round_search(const ConvexShape& a, const Isometry3d& pose_a, const ConvexShape& b,
                         const Isometry3d& pose_b, const PointSimplex& reached) {
  const Vector3d offset = pose_a.translation() - pose_b.translation();
  FoundPoints on_a{a, pose_a, offset, {}, {}}, on_b{b, pose_b, Vector3d::Zero(), {}, {}};
  for (std::size_t i = 0; i < reached.size; ++i) {
    on_a.add(reached.pairs[i].a);
    on_b.add(reached.pairs[i].b);
  }
  if (reached.size == 0) {
    on_a.add(on_a.farthest_along(-offset));
    on_b.add(on_b.farthest_along(offset));
  }
  const double extent = offset.lpNorm<1>() + a.data().support.reach + b.data().support.reach;
  // Bounds the error of a support value, as in the filter, plus the displacement of points moved inwards.
  const double error = 0x1p-45 * extent;
  PairSimplex simplex;
  ShapesUndecided undecided{};
  undecided.overlap = std::numeric_limits<double>::infinity();
  // About twenty iterations are needed where the shapes nearly touch. A pair still open after this many is
  // reported as undecided.
  constexpr int most_rounds = 300;
  for (int round = 0; round < most_rounds; ++round) {
    const HullPair hulls{on_a.positions, on_b.positions, Vector3d::Zero(), extent, coordinate_error_of_moved};
    double distance = 0;
    const ExactNearest nearest = nearest_of(hulls, on_a, on_b, simplex, distance);
    simplex = nearest.simplex;
    if (distance == 0)
      return {true, ShapesMeet{simplex_of(simplex, on_a, on_b)}};
    const Vector3d direction = direction_of(negated(nearest.point)).normalized();
    const Vector3d far_a = on_a.farthest_along(direction), far_b = on_b.farthest_along(-direction);
    const Vector3d difference = pose_a.linear() * far_a + offset - pose_b.linear() * far_b;
    const double overlap = difference.dot(direction);
    if (overlap < -error)
      return {false, ShapesSeparated{direction}};
    undecided.gap = distance * (1 + 0x1p-50);
    undecided.simplex = simplex_of(simplex, on_a, on_b);
    if (overlap + error < undecided.overlap) {
      undecided.overlap = overlap + error;
      undecided.direction = direction;
    }
    if (overlap <= error - distance)
      break;
    simplex.pairs[simplex.size++] = {on_a.add(far_a), on_b.add(far_b)};
  }
  return {true, undecided};
}

}  // namespace fringe::detail
