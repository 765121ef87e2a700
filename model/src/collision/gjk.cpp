#include "fringe/gjk.hpp"

#include <utility>

#include "exact_search.hpp"
#include "float_search.hpp"
#include "hull_pair.hpp"

namespace fringe {
namespace {

using detail::ExactHulls;
using detail::ExactNearest;
using detail::Goal;
using detail::Integer;
using Eigen::Vector3d;

GjkAnswer answer_of(const ExactHulls& exact, const ExactNearest& nearest) {
  if (detail::dot(nearest.point, nearest.point).is_zero())
    return {true, SimplexAroundOrigin{nearest.simplex}};
  const Vector3d direction = detail::direction_of(detail::negated(nearest.point));
  if (detail::separates(exact, direction))
    return {false, SeparatingDirection{direction}};
  return {false, SeparatingSimplex{nearest.simplex}};
}

/// Σ weightsᵢ vertexᵢ/total, rounded.
template <class VertexOf>
Vector3d combination(const ExactHulls& exact, const ExactNearest& nearest, VertexOf vertex_of) {
  detail::ExactVector sum;
  for (std::size_t i = 0; i < nearest.simplex.size; ++i) {
    const detail::ExactVector vertex = detail::in_units(vertex_of(nearest.simplex.pairs[i]), exact.unit);
    for (std::size_t k = 0; k < 3; ++k)
      sum[k] += nearest.weights[i] * vertex[k];
  }
  return {detail::rounded_quotient(sum[0], nearest.total, exact.unit),
          detail::rounded_quotient(sum[1], nearest.total, exact.unit),
          detail::rounded_quotient(sum[2], nearest.total, exact.unit)};
}

}  // namespace

GjkAnswer gjk_intersects(std::span<const Vector3d> a, std::span<const Vector3d> b) {
  const detail::HullPair hulls = detail::hull_pair(a, b);
  const auto [answer, reached] = detail::float_search(hulls, Goal::decision);
  if (answer)
    return *answer;
  const ExactHulls exact = detail::exact_hulls(hulls);
  return answer_of(exact, detail::exact_search(exact, reached, Goal::decision));
}

HullDistance gjk_distance(std::span<const Vector3d> a, std::span<const Vector3d> b) {
  const detail::HullPair hulls = detail::hull_pair(a, b);
  const ExactHulls exact = detail::exact_hulls(hulls);
  const ExactNearest nearest =
      detail::exact_search(exact, detail::float_search(hulls, Goal::distance).reached, Goal::distance);
  const Integer square = detail::dot(nearest.point, nearest.point);
  return {detail::rounded_root_quotient(square, nearest.total, exact.unit),
          combination(exact, nearest, [=](VertexPair pair) { return a[pair.a]; }),
          combination(exact, nearest, [=](VertexPair pair) { return b[pair.b]; })};
}

}  // namespace fringe
