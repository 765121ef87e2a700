#include <array>
#include <cmath>
#include <optional>

#include "collision/convex_shape_data.hpp"
#include "collision/posed_hulls.hpp"
#include "collision/round_search.hpp"
#include "fringe/convex_shape.hpp"
#include "fringe/error.hpp"
#include "simd/dispatch.hpp"

namespace fringe {
namespace {

using detail::ConvexShapeData;
using detail::GjkFilterAnswer;
using detail::PlacedShape;
using detail::Verdict;
using Eigen::Isometry3d;
using Eigen::Vector3d;

PlacedShape placed(const ConvexShape& shape, const Isometry3d& pose) {
  return {&shape.data().support, pose.data()};
}

PointSimplex simplex_of(const GjkFilterAnswer& answer) {
  PointSimplex simplex;
  for (int i = 0; i < answer.size; ++i)
    simplex.pairs[simplex.size++] = {Vector3d(answer.pairs[i].on_a), Vector3d(answer.pairs[i].on_b)};
  return simplex;
}

PointSimplex simplex_of(const PairSimplex& pairs, const ConvexShapeData& a, const ConvexShapeData& b) {
  PointSimplex simplex;
  for (std::size_t i = 0; i < pairs.size; ++i)
    simplex.pairs[simplex.size++] = {a.vertices[pairs.pairs[i].a], b.vertices[pairs.pairs[i].b]};
  return simplex;
}

PairSimplex pairs_of(const GjkFilterAnswer& answer) {
  PairSimplex simplex;
  for (int i = 0; i < answer.size; ++i)
    simplex.pairs[simplex.size++] = {answer.pairs[i].a, answer.pairs[i].b};
  return simplex;
}

/// Decides whether two polytopes intersect, in integers.
ShapeAnswer decide_exactly(const ConvexShape& a, const Isometry3d& pose_a, const ConvexShape& b,
                           const Isometry3d& pose_b, const PairSimplex& start) {
  const detail::PosedHulls hulls(a, pose_a, b, pose_b);
  const detail::ExactNearest nearest = detail::exact_search(hulls.exact(), start, detail::Goal::decision);
  const PointSimplex simplex = simplex_of(nearest.simplex, a.data(), b.data());
  if (detail::dot(nearest.point, nearest.point).is_zero())
    return {true, ShapesMeet{simplex}};
  const Vector3d direction = detail::direction_of(detail::negated(nearest.point));
  if (detail::separates(hulls.exact(), direction))
    return {false, ShapesSeparated{direction}};
  return {false, ShapesSeparatedBySimplex{simplex}};
}

}  // namespace

bool intersect(const ConvexShape& a, const Isometry3d& pose_a, const ConvexShape& b,
               const Isometry3d& pose_b) {
  const Verdict verdict =
      detail::best_kernels<detail::GjkFilter>().decide(placed(a, pose_a), placed(b, pose_b));
  if (verdict != Verdict::undecided)
    return verdict == Verdict::intersecting;
  return gjk_intersects(a, pose_a, b, pose_b).intersects;
}

ShapeAnswer gjk_intersects(const ConvexShape& a, const Isometry3d& pose_a, const ConvexShape& b,
                           const Isometry3d& pose_b) {
  if (!pose_a.matrix().allFinite() || !pose_b.matrix().allFinite())
    throw InputError("a pose must be finite");
  GjkFilterAnswer answer;
  detail::best_kernels<detail::GjkFilter>().prove(placed(a, pose_a), placed(b, pose_b), answer);
  if (answer.verdict == Verdict::disjoint)
    return {false, ShapesSeparated{Vector3d(answer.direction)}};
  // For round shapes the simplex proves nothing yet, since its points are rounded and may lie outside.
  if (a.is_round() || b.is_round())
    return detail::round_search(a, pose_a, b, pose_b, simplex_of(answer));
  if (answer.verdict == Verdict::intersecting)
    return {true, ShapesMeet{simplex_of(answer)}};
  return decide_exactly(a, pose_a, b, pose_b, pairs_of(answer));
}

}  // namespace fringe
