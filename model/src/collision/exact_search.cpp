#include "exact_search.hpp"

#include <limits>
#include <utility>

#include "nearest_face.hpp"

namespace fringe::detail {
namespace {

/// A vertex with the largest product with the direction, and that product in units.
struct ExactExtreme {
  std::size_t index = 0;
  Integer product;
};

ExactExtreme exactly_farthest_along(const ExactHulls& exact, Vertices vertices,
                                    const ExactVector& direction) {
  const HullPair& hulls = exact.hulls;
  const Eigen::Vector3d rounded = direction_of(direction);
  double threshold = -std::numeric_limits<double>::infinity();
  if (in_safe_range(hulls))
    threshold = farthest_along(vertices, hulls.origin, rounded).product - 2 * product_error(hulls, rounded);
  ExactExtreme extreme;
  bool found = false;
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    // Written so that what is not a number is compared exactly.
    if ((vertices[i] - hulls.origin).dot(rounded) < threshold)
      continue;
    Integer product = dot(in_units(vertices[i], exact.unit), direction);
    if (!found || product > extreme.product)
      extreme = {i, std::move(product)};
    found = true;
  }
  return extreme;
}

ExactVector point_of(const ExactHulls& exact, VertexPair pair) {
  return difference(in_units(exact.hulls.a[pair.a], exact.unit), in_units(exact.hulls.b[pair.b], exact.unit));
}

ExactNearest nearest_of(const ExactHulls& exact, const PairSimplex& simplex) {
  std::array<ExactVector, 4> points;
  for (std::size_t i = 0; i < simplex.size; ++i)
    points[i] = point_of(exact, simplex.pairs[i]);
  Gram<Integer> gram;
  for (std::size_t i = 0; i < simplex.size; ++i)
    for (std::size_t j = 0; j <= i; ++j)
      gram[i][j] = gram[j][i] = dot(points[i], points[j]);
  const NearestFace<Integer> face = nearest_face(gram, simplex.size).value();
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

}  // namespace

ExactHulls exact_hulls(const HullPair& hulls) {
  return {hulls, common_unit(hulls.a, common_unit(hulls.b, std::numeric_limits<int>::max()))};
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
    const ExactExtreme a = exactly_farthest_along(exact, exact.hulls.a, direction);
    const ExactExtreme b = exactly_farthest_along(exact, exact.hulls.b, nearest.point);
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
  const ExactExtreme a = exactly_farthest_along(exact, exact.hulls.a, scaled);
  const ExactExtreme b = exactly_farthest_along(exact, exact.hulls.b, negated(scaled));
  return a.product + b.product < 0;
}

}  // namespace fringe::detail
