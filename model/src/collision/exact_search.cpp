#include "collision/exact_search.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <utility>

#include "collision/nearest_face.hpp"

namespace fringe::detail {
namespace {

using Eigen::Vector3d;

/// A support point: its index and its product with the direction, in units.
struct ExactExtreme {
  std::size_t index = 0;
  Integer product;
};

/// Finds an exact support point. Only vertices whose rounded products are within the error bound of the
/// largest are compared in integers.
ExactExtreme exactly_farthest_along(const ExactHulls& exact, Vertices vertices,
                                    const ExactVertices& positions, const ExactVector& direction) {
  const HullPair& hulls = exact.hulls;
  const Eigen::Vector3d rounded = direction_of(direction);
  double threshold = -std::numeric_limits<double>::infinity();
  if (in_safe_range(hulls))
    threshold = farthest_along(vertices, hulls.origin, rounded).product - 2 * product_error(hulls, rounded);
  ExactExtreme extreme;
  bool found = false;
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    // Written so that a NaN is compared exactly.
    if ((vertices[i] - hulls.origin).dot(rounded) < threshold)
      continue;
    Integer product = dot(positions.position(i, exact.unit), direction);
    if (!found || product > extreme.product)
      extreme = {i, std::move(product)};
    found = true;
  }
  return extreme;
}

/// Returns the point a − b of a pair.
ExactVector point_of(const ExactHulls& exact, VertexPair pair) {
  return difference(exact.a.position(pair.a, exact.unit), exact.b.position(pair.b, exact.unit));
}

/// Finds the point of the simplex nearest to the origin, and reduces the simplex to the face that contains
/// it.
ExactNearest nearest_of(const ExactHulls& exact, const PairSimplex& simplex) {
  std::array<ExactVector, 4> points;
  for (std::size_t i = 0; i < simplex.size; ++i)
    points[i] = point_of(exact, simplex.pairs[i]);
  std::array<std::array<Integer, 4>, 4> gram;
  for (std::size_t i = 0; i < simplex.size; ++i)
    for (std::size_t j = 0; j <= i; ++j)
      gram[i][j] = gram[j][i] = dot(points[i], points[j]);
  const auto product = [&](std::size_t i, std::size_t j, std::size_t k) -> Integer {
    return gram[i][j] - gram[i][k];
  };
  const NearestFace<Integer> face = nearest_face<Integer>(product, simplex.size).value();
  ExactNearest nearest;
  for (std::size_t i = 0; i < simplex.size; ++i) {
    if (!holds(face.members, i))
      continue;
    nearest.simplex.pairs[nearest.simplex.size] = simplex.pairs[i];
    nearest.weights[nearest.simplex.size] = face.weights[i];
    ++nearest.simplex.size;
    nearest.total += face.weights[i];
    for (std::size_t k = 0; k < 3; ++k)
      nearest.point[k] += face.weights[i] * points[i][k];
  }
  return nearest;
}

/// Computes Σ weightsᵢ positionᵢ/total, rounded.
template <class PositionOf>
Vector3d combination(const ExactHulls& exact, const ExactNearest& nearest, const PositionOf& position_of) {
  ExactVector sum;
  for (std::size_t i = 0; i < nearest.simplex.size; ++i) {
    const ExactVector position = position_of(nearest.simplex.pairs[i]);
    for (std::size_t k = 0; k < 3; ++k)
      sum[k] += nearest.weights[i] * position[k];
  }
  return {rounded_quotient(sum[0], nearest.total, exact.unit),
          rounded_quotient(sum[1], nearest.total, exact.unit),
          rounded_quotient(sum[2], nearest.total, exact.unit)};
}

}  // namespace

HullDistance rounded_distance(const ExactHulls& exact, const ExactNearest& nearest) {
  return {rounded_root_quotient(dot(nearest.point, nearest.point), nearest.total, exact.unit),
          combination(exact, nearest, [&](VertexPair pair) { return exact.a.position(pair.a, exact.unit); }),
          combination(exact, nearest, [&](VertexPair pair) { return exact.b.position(pair.b, exact.unit); })};
}

ExactHulls exact_hulls(const HullPair& hulls) {
  return exact_hulls(hulls, ExactVertices(hulls.a), ExactVertices(hulls.b));
}

ExactHulls exact_hulls(const HullPair& hulls, const ExactVertices& a, const ExactVertices& b) {
  return {hulls, a, b, std::min(a.unit(), b.unit())};
}

ExactVertices::ExactVertices(Vertices vertices)
    : vertices_(vertices), own_unit_(common_unit(vertices, std::numeric_limits<int>::max())),
      unit_(own_unit_) {}

ExactVertices::ExactVertices(Vertices vertices, const Eigen::Isometry3d& pose)
    : vertices_(vertices), pose_(&pose) {
  // If all coordinates are zero, any unit will do.
  own_unit_ = common_unit(vertices, 0);
  const std::array<Vector3d, 3> columns{pose.linear().col(0), pose.linear().col(1), pose.linear().col(2)};
  matrix_unit_ = common_unit(columns, 0);
  const Vector3d translation = pose.translation();
  unit_ = common_unit({&translation, 1}, own_unit_ + matrix_unit_);
}

ExactVector ExactVertices::position(std::size_t index, int unit) const {
  if (pose_ == nullptr)
    return in_units(vertices_[index], unit);
  const ExactVector vertex = in_units(vertices_[index], own_unit_);
  ExactVector moved = in_units(pose_->translation(), unit);
  for (std::size_t column = 0; column < 3; ++column) {
    const ExactVector axis = in_units(pose_->linear().col(static_cast<Eigen::Index>(column)), matrix_unit_);
    for (std::size_t k = 0; k < 3; ++k)
      moved[k] += Integer(axis[k] * vertex[column]) << static_cast<unsigned>(own_unit_ + matrix_unit_ - unit);
  }
  return moved;
}

ExactNearest exact_search(const ExactHulls& exact, const PairSimplex& start, Goal goal) {
  PairSimplex simplex = start;
  if (simplex.size == 0)
    simplex.size = 1;
  while (true) {
    ExactNearest nearest = nearest_of(exact, simplex);
    const Integer square = dot(nearest.point, nearest.point);
    if (square.is_zero())
      return nearest;
    const ExactVector direction = negated(nearest.point);
    const ExactExtreme a = exactly_farthest_along(exact, exact.hulls.a, exact.a, direction);
    const ExactExtreme b = exactly_farthest_along(exact, exact.hulls.b, exact.b, nearest.point);
    const Integer least = -(a.product + b.product);
    if (goal == Goal::decision ? least > 0 : nearest.total * least >= square)
      return nearest;
    simplex = nearest.simplex;
    simplex.pairs[simplex.size++] = {a.index, b.index};
  }
}

bool separates(const ExactHulls& exact, const Eigen::Vector3d& direction) {
  const ExactVector scaled =
      in_units(direction, common_unit({&direction, 1}, std::numeric_limits<int>::max()));
  const ExactExtreme a = exactly_farthest_along(exact, exact.hulls.a, exact.a, scaled);
  const ExactExtreme b = exactly_farthest_along(exact, exact.hulls.b, exact.b, negated(scaled));
  return a.product + b.product < 0;
}

}  // namespace fringe::detail
