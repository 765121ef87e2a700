#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include <Eigen/LU>

#include "collision/scaled_points.hpp"
#include "fringe/bounding_volume.hpp"

namespace fringe {
namespace {

using Eigen::Vector3d;

/// Computes the circumcentre of one to four points in the affine space they span; not finite if they are
/// affinely dependent.
Vector3d circumcentre(const std::vector<Vector3d>& points) {
  const auto edges = static_cast<Eigen::Index>(points.size()) - 1;
  Eigen::Matrix<double, 3, Eigen::Dynamic, 0, 3, 3> edge(3, edges);
  for (Eigen::Index i = 0; i < edges; ++i)
    edge.col(i) = points[static_cast<std::size_t>(i) + 1] - points[0];
  if (edges == 0)
    return points[0];
  const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 3, 3> gram = edge.transpose() * edge;
  const Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 3, 1> half_squares = gram.diagonal() / 2;
  return points[0] + edge * gram.partialPivLu().solve(half_squares);
}

/// The vertex farthest from the centre, and its squared distance.
struct Farthest {
  std::size_t index;
  double square;
};

Farthest farthest_from(const Vector3d& centre, const std::vector<Vector3d>& points) {
  Farthest farthest{0, 0};
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double square = (points[i] - centre).squaredNorm();
    if (square > farthest.square)
      farthest = {i, square};
  }
  return farthest;
}

struct Ball {
  Vector3d centre;
  double square;                   ///< squared radius
  std::vector<Vector3d> boundary;  ///< the points on it that determine it
};

/// Finds the smallest ball around at most five points. It is the circumscribed ball of a subset; among the
/// circumscribed balls of all subsets, it is the one whose farthest point is nearest. No containment test is
/// needed, and so no tolerance.
Ball smallest_around(const std::vector<Vector3d>& points) {
  Ball best{points[0], std::numeric_limits<double>::infinity(), {}};
  for (unsigned subset = 1; subset < (1U << points.size()); ++subset) {
    std::vector<Vector3d> boundary;
    for (std::size_t i = 0; i < points.size(); ++i)
      if (((subset >> i) & 1U) != 0)
        boundary.push_back(points[i]);
    if (boundary.size() > 4)
      continue;
    const Vector3d centre = circumcentre(boundary);
    const double square = farthest_from(centre, points).square;
    if (centre.allFinite() && square < best.square)
      best = {centre, square, boundary};
  }
  return best;
}

}  // namespace

BoundingSphere bounding_sphere(std::span<const Vector3d> vertices) {
  const auto [points, middle, exponent] = detail::scaled_points(vertices);
  Vector3d centre = middle;
  Farthest farthest = farthest_from(centre, points);
  Ball ball{points.front(), 0, {points.front()}};
  // The ball of the boundary points grows with every iteration; it is the smallest once rounding hides the
  // growth.
  while (true) {
    const Farthest outside = farthest_from(ball.centre, points);
    if (outside.square < farthest.square) {
      centre = ball.centre;
      farthest = outside;
    }
    std::vector<Vector3d> candidates = ball.boundary;
    candidates.push_back(points[outside.index]);
    Ball next = smallest_around(candidates);
    if (!(next.square > ball.square))
      break;
    ball = std::move(next);
  }
  // The six roundings of the squared distance count half in the radius; the remainder of the margin makes a
  // distance that a caller rounds anew still smaller than the radius.
  constexpr double outward = 1 + 8 * std::numeric_limits<double>::epsilon();
  // The absolute error that the centre and the radius can have in the subnormal range.
  constexpr double smallest = 3 * std::numeric_limits<double>::denorm_min();
  const auto in_given_unit = [e = exponent](double x) { return std::ldexp(x, e); };
  return {centre.unaryExpr(in_given_unit), in_given_unit(std::sqrt(farthest.square) * outward) + smallest};
}

}  // namespace fringe
