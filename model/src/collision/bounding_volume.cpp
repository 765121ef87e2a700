#include "collision/bounding_volume.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <fmt/format.h>

#include "fringe/bounding_volume.hpp"
#include "fringe/error.hpp"
#include "fringe/triangle.hpp"

namespace fringe::detail {

ScaledPoints scaled_points(std::span<const Eigen::Vector3d> points) {
  const Eigen::AlignedBox3d box = axis_aligned_box(points);
  const double largest = std::max(box.min().cwiseAbs().maxCoeff(), box.max().cwiseAbs().maxCoeff());
  const int exponent = largest == 0 ? 0 : std::ilogb(largest) + 1;
  const auto scaled = [=](const Eigen::Vector3d& point) -> Eigen::Vector3d {
    return point.unaryExpr([=](double x) { return std::ldexp(x, -exponent); });
  };
  ScaledPoints result{{}, (scaled(box.min()) + scaled(box.max())) / 2, exponent};
  result.points.reserve(points.size());
  for (const Eigen::Vector3d& point : points)
    result.points.push_back(scaled(point));
  return result;
}

namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

/// Returns eigenvectors as rows. They are orthonormal even for equal eigenvalues, since the solver applies
/// orthogonal transformations only.
Matrix3d eigenvectors(const Matrix3d& covariance) {
  const Eigen::SelfAdjointEigenSolver<Matrix3d> solver(covariance);
  return solver.eigenvectors().rowwise().reverse().transpose();
}

}  // namespace

Matrix3d axes_of_vertices(const std::vector<Vector3d>& points) {
  Vector3d mean = Vector3d::Zero();
  for (const Vector3d& point : points)
    mean += point / static_cast<double>(points.size());
  Matrix3d covariance = Matrix3d::Zero();
  for (const Vector3d& point : points)
    covariance += (point - mean) * (point - mean).transpose();
  return eigenvectors(covariance);
}

Matrix3d axes_of_triangles(const std::vector<Vector3d>& points, std::span<const Face> faces) {
  double total = 0;
  Vector3d weighted = Vector3d::Zero();
  for (const auto& [i, j, k] : faces) {
    const double weight = twice_area({points[i], points[j], points[k]});
    total += weight;
    weighted += weight * (points[i] + points[j] + points[k]) / 3;
  }
  if (total == 0)
    return axes_of_vertices(points);
  const Vector3d mean = weighted / total;
  Matrix3d covariance = Matrix3d::Zero();
  for (const auto& [i, j, k] : faces) {
    const Vector3d p = points[i] - mean, q = points[j] - mean, r = points[k] - mean, sum = p + q + r;
    covariance += twice_area({points[i], points[j], points[k]}) / total *
                  (sum * sum.transpose() + p * p.transpose() + q * q.transpose() + r * r.transpose());
  }
  return eigenvectors(covariance);
}

}  // namespace fringe::detail

namespace fringe {

Eigen::AlignedBox3d axis_aligned_box(std::span<const Eigen::Vector3d> vertices) {
  if (vertices.empty())
    throw InputError("there are no vertices to bound");
  Eigen::AlignedBox3d box;
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    if (!vertices[i].allFinite())
      throw InputError(fmt::format("vertex {} is not finite", i));
    box.extend(vertices[i]);
  }
  return box;
}

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

namespace {

using Eigen::Matrix3d;

void check(std::span<const Face> faces, std::size_t vertices) {
  for (std::size_t i = 0; i < faces.size(); ++i)
    for (const std::size_t vertex : faces[i])
      if (vertex >= vertices)
        throw InputError(fmt::format("face {} names vertex {}; there are {} vertices", i, vertex, vertices));
}

/// Makes the rows orthonormal up to rounding and right-handed; they must be so already up to sign and small
/// errors.
Matrix3d right_handed(const Matrix3d& axes) {
  Matrix3d result;
  const Vector3d first = axes.row(0).normalized();
  const Vector3d second = (axes.row(1).transpose() - axes.row(1).dot(first) * first).normalized();
  result << first.transpose(), second.transpose(), first.cross(second).transpose();
  return result;
}

Matrix3d axes_by(BoxMethod method, const std::vector<Vector3d>& points, std::span<const Face> faces) {
  switch (method) {
  case BoxMethod::vertices:
    return detail::axes_of_vertices(points);
  case BoxMethod::triangles:
    return detail::axes_of_triangles(points, faces);
  case BoxMethod::tight:
    return detail::tight_axes(points, faces);
  }
  throw InputError("unknown method for an oriented box");
}

/// Returns the centre of the points' extent along the axes.
Vector3d middle_along(const Matrix3d& axes, const std::vector<Vector3d>& points, const Vector3d& from) {
  Vector3d lowest = Vector3d::Constant(std::numeric_limits<double>::infinity()), highest = -lowest;
  for (const Vector3d& point : points) {
    const Vector3d along = axes * (point - from);
    lowest = lowest.cwiseMin(along);
    highest = highest.cwiseMax(along);
  }
  return from + axes.transpose() * ((lowest + highest) / 2);
}

}  // namespace

BoxMethod parse_box_method(std::string_view text) {
  if (text == "vertices")
    return BoxMethod::vertices;
  if (text == "triangles")
    return BoxMethod::triangles;
  if (text == "tight")
    return BoxMethod::tight;
  throw InputError(
      fmt::format("unknown method '{}' for an oriented box: use vertices, triangles or tight", text));
}

OrientedBox oriented_box(std::span<const Vector3d> vertices, std::span<const Face> faces, BoxMethod method) {
  const auto [points, middle, exponent] = detail::scaled_points(vertices);
  check(faces, points.size());
  const Matrix3d axes = right_handed(axes_by(method, points, faces));
  const Vector3d centre = middle_along(axes, points, middle);
  Vector3d half_widths = Vector3d::Zero();
  double farthest = 0;
  for (const Vector3d& point : points) {
    const Vector3d offset = point - centre;
    half_widths = half_widths.cwiseMax((axes * offset).cwiseAbs());
    farthest = std::max(farthest, offset.norm());
  }
  // Four roundings stand between a coordinate and a height, and the axes are orthonormal to a few more. The
  // margin is twice that, so that a height computed anew by a caller is still inside.
  const double outward = 8 * std::numeric_limits<double>::epsilon() * farthest;
  // The absolute error that the centre and the half-widths can have in the subnormal range.
  constexpr double smallest = 4 * std::numeric_limits<double>::denorm_min();
  const auto in_given_unit = [e = exponent](double x) { return std::ldexp(x, e); };
  return {centre.unaryExpr(in_given_unit), axes,
          (half_widths.array() + outward).unaryExpr(in_given_unit) + smallest};
}

}  // namespace fringe
