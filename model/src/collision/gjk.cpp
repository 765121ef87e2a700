#include "fringe/gjk.hpp"

#include <optional>

#include "collision/convex_pair.hpp"
#include "collision/convex_shape_data.hpp"
#include "collision/minkowski_difference.hpp"
#include "fringe/convex_shape.hpp"
#include "fringe/error.hpp"
#include "simd/dispatch.hpp"

/// The queries: by the filter if it proves the answer, otherwise by the iteration in other numbers
/// (model/NUMERICS.md, section 13).
namespace fringe {
namespace {

using detail::ConvexPair;
using detail::DistanceAnswer;
using detail::DistanceEnd;
using detail::Dyadic;
using detail::GjkFilterAnswer;
using detail::Goal;
using detail::HullDistance;
using detail::NearestFace;
using detail::Verdict;
using Eigen::Isometry3d;
using Eigen::Vector3d;

/// Returns the simplex that a search in floating point has reached, or one to start with if there was none.
Simplex reached_simplex(const ConvexPair& pair, const auto& answer) {
  if (answer.size == 0)
    return pair.start();
  Simplex simplex;
  for (int i = 0; i < answer.size; ++i)
    simplex.pairs[simplex.size++] = pair.filter_points(answer.pairs[i]);
  return simplex;
}

/// Decides whether two polytopes intersect, in exact arithmetic.
GjkAnswer decide_exactly(const ConvexPair& pair, const Simplex& reached) {
  detail::PolytopeDifference difference(pair, Goal::decision);
  const NearestFace<Dyadic> face = detail::gjk<Dyadic>(difference, reached);
  if (face.nearest.squaredNorm().sign() == 0)
    return {true, SimplexAroundOrigin{face.simplex}};
  const Vector3d direction = detail::direction_of(-face.nearest);
  if (difference.separates(direction))
    return {false, SeparatingDirection{direction}};
  return {false, SeparatingSimplex{face.simplex}};
}

/// Decides whether two shapes intersect, one of which is round.
GjkAnswer decide_round(const ConvexPair& pair, Simplex reached) {
  detail::RoundDifference difference(pair);
  for (std::size_t i = 0; i < reached.size; ++i)
    reached.pairs[i] = difference.inside(reached.pairs[i]);
  detail::gjk<Dyadic>(difference, reached);
  return difference.answer();
}

GjkAnswer decide(const ConvexPair& pair) {
  GjkFilterAnswer filtered;
  detail::best_kernels<detail::GjkFilter>().prove(pair.a.filtered(), pair.b.filtered(), filtered);
  if (filtered.verdict == Verdict::disjoint)
    return {false, SeparatingDirection{Vector3d(filtered.direction)}};
  const Simplex reached = reached_simplex(pair, filtered);
  // For round shapes the simplex proves nothing yet, since its points are rounded and may lie outside.
  if (pair.is_round())
    return decide_round(pair, reached);
  if (filtered.verdict == Verdict::intersecting)
    return {true, SimplexAroundOrigin{reached}};
  return decide_exactly(pair, reached);
}

/// Returns the moved points of the shapes whose difference is the sum of a simplex's points times weights.
PointPair witnesses(const ConvexPair& pair, const Simplex& simplex, std::span<const double> weights) {
  PointPair sum{Vector3d::Zero(), Vector3d::Zero()};
  for (std::size_t i = 0; i < simplex.size; ++i) {
    sum.a += weights[i] * simplex.pairs[i].a;
    sum.b += weights[i] * simplex.pairs[i].b;
  }
  return {*pair.a.pose * sum.a, *pair.b.pose * sum.b};
}

/// Searches the shortest distance in floating point.
DistanceAnswer approach(const ConvexPair& pair) {
  DistanceAnswer answer;
  detail::best_kernels<detail::GjkFilter>().approach(pair.a.filtered(), pair.b.filtered(), answer);
  return answer;
}

/// Returns the distance that was found in floating point.
GjkDistance rounded_distance(const ConvexPair& pair, const DistanceAnswer& found, const Simplex& reached) {
  const auto [on_a, on_b] = witnesses(pair, reached, found.weights);
  return {found.length, found.lower_bound, Vector3d(found.direction), on_a, on_b, false};
}

/// Solves the distance of two polytopes in exact arithmetic.
GjkDistance solve_exactly(const ConvexPair& pair, const Simplex& start) {
  detail::PolytopeDifference difference(pair, Goal::distance);
  return difference.distance(detail::gjk<Dyadic>(difference, start));
}

/// Returns the distance of shapes that intersect: zero, with the point of the certificate's simplex nearest
/// to the origin as a point of each shape.
GjkDistance common_point(const ConvexPair& pair, const GjkAnswer& answer) {
  const auto* around = std::get_if<SimplexAroundOrigin>(&answer.certificate);
  const Simplex& simplex = around ? around->simplex : std::get<HiddenByRounding>(answer.certificate).simplex;
  NearestFace<double> rounded;
  for (std::size_t i = 0; i < simplex.size; ++i)
    rounded.add(simplex.pairs[i], pair.difference(simplex.pairs[i]));
  if (rounded.reduce() && rounded.nearest.norm() <= pair.rounding()) {
    const auto [on_a, on_b] = witnesses(pair, rounded.simplex, rounded.weights);
    return {0, 0, Vector3d::Zero(), on_a, on_b, false};
  }
  // Where surfaces touch, rounding may make the simplex miss the common point.
  const detail::ExactDifference exact(pair);
  NearestFace<Dyadic> face;
  for (std::size_t i = 0; i < simplex.size; ++i)
    face.add(simplex.pairs[i], exact.point(simplex.pairs[i]));
  face.reduce();
  const GjkDistance solved = exact.distance(face);
  return {0, 0, Vector3d::Zero(), solved.witness_a, solved.witness_b, !pair.is_round()};
}

/// A shape as what a ball sweeps: a box, which may be a segment or a point; other shapes with a ball of
/// radius zero.
struct Swept {
  ConvexShape core;
  double radius;
};

Swept swept(const ConvexShape& shape) {
  const detail::SupportShape& support = shape.data().support;
  if (support.kind == detail::ShapeKind::rounded_box)
    return {ConvexShape::cuboid(2 * Vector3d(support.size)), support.ends[0]};
  if (support.kind == detail::ShapeKind::ball)
    return {ConvexShape::cuboid(Vector3d::Zero()), support.size[0]};
  return {shape, 0};
}

/// Tests whether a distance is found better between what balls sweep: many points of a rounded edge are
/// almost equally far away, and the search among them ends early.
bool is_rounded(const ConvexShape& shape) {
  return shape.data().support.kind == detail::ShapeKind::rounded_box;
}

/// Computes the distance of swept shapes from that of what balls sweep; nothing if they meet, or nearly do.
std::optional<GjkDistance> distance_of_swept(const ConvexShape& a, const Isometry3d& pose_a,
                                             const ConvexShape& b, const Isometry3d& pose_b,
                                             double rounding) {
  const Swept of_a = swept(a), of_b = swept(b);
  GjkDistance found = gjk_distance(of_a.core, pose_a, of_b.core, pose_b);
  const double radii = of_a.radius + of_b.radius;
  if (!(found.lower_bound - radii > rounding))
    return std::nullopt;
  found.distance -= radii;
  found.lower_bound -= radii + rounding;
  found.witness_a += of_a.radius * found.direction;
  found.witness_b -= of_b.radius * found.direction;
  found.exact = false;
  return found;
}

/// Checks that all numbers are finite: zero times any other number is NaN.
void check_pose(const Isometry3d& pose) {
  if (!((0 * pose.matrix()).sum() == 0))
    throw InputError("a pose must be finite");
}

}  // namespace

GjkAnswer gjk_intersects(std::span<const Vector3d> a, std::span<const Vector3d> b) {
  return decide(detail::PassingHulls(a, b).pair());
}

GjkDistance gjk_distance(std::span<const Vector3d> a, std::span<const Vector3d> b) {
  const detail::PassingHulls hulls(a, b);
  HullDistance found;
  detail::best_kernels<detail::GjkFilter>().hull_distance(hulls.a().given(), hulls.b().given(), found);
  if (found.is_certain)
    return {found.distance,       found.lower_bound,    Vector3d(found.direction),
            Vector3d(found.on_a), Vector3d(found.on_b), true};
  Simplex reached;
  for (int i = 0; i < found.simplex.size; ++i)
    reached.pairs[reached.size++] = {a[found.simplex.a[i]], b[found.simplex.b[i]]};
  const ConvexPair pair = hulls.pair();
  return solve_exactly(pair, reached.size == 0 ? pair.start() : reached);
}

bool intersect(const ConvexShape& a, const Isometry3d& pose_a, const ConvexShape& b,
               const Isometry3d& pose_b) {
  const Verdict verdict = detail::best_kernels<detail::GjkFilter>().decide(
      {&a.data().support, pose_a.data()}, {&b.data().support, pose_b.data()});
  if (verdict != Verdict::undecided)
    return verdict == Verdict::intersecting;
  return gjk_intersects(a, pose_a, b, pose_b).intersects;
}

GjkAnswer gjk_intersects(const ConvexShape& a, const Isometry3d& pose_a, const ConvexShape& b,
                         const Isometry3d& pose_b) {
  check_pose(pose_a);
  check_pose(pose_b);
  return decide(detail::convex_pair(a, pose_a, b, pose_b));
}

GjkDistance gjk_distance(const ConvexShape& a, const Isometry3d& pose_a, const ConvexShape& b,
                         const Isometry3d& pose_b) {
  check_pose(pose_a);
  check_pose(pose_b);
  const ConvexPair pair = detail::convex_pair(a, pose_a, b, pose_b);
  if (!pair.is_in_safe_range()) {
    if (!pair.is_round())
      return solve_exactly(pair, pair.start());
    throw InputError(
        "the sizes and the offset of round shapes must add up to a length between 2^-170 and 2^170");
  }
  if (is_rounded(a) || is_rounded(b))
    if (const std::optional<GjkDistance> found = distance_of_swept(a, pose_a, b, pose_b, pair.rounding()))
      return *found;
  DistanceAnswer found = approach(pair);
  if (found.end == DistanceEnd::open && !pair.is_round())
    detail::best_kernels<detail::GjkFilter>().refine(pair.a.filtered(), pair.b.filtered(), found);
  const Simplex reached = reached_simplex(pair, found);
  if (found.end == DistanceEnd::converged)
    return rounded_distance(pair, found, reached);
  if (found.end == DistanceEnd::intersecting && !pair.is_round()) {
    Vector3d apart = Vector3d::Zero();
    for (std::size_t i = 0; i < reached.size; ++i)
      apart += found.weights[i] * pair.difference(reached.pairs[i]);
    if (apart.norm() <= pair.rounding()) {
      const auto [on_a, on_b] = witnesses(pair, reached, found.weights);
      return {0, 0, Vector3d::Zero(), on_a, on_b, false};
    }
  }
  const GjkAnswer answer = decide(pair);
  if (answer.intersects)
    return common_point(pair, answer);
  return pair.is_round() ? rounded_distance(pair, found, reached) : solve_exactly(pair, reached);
}

}  // namespace fringe
