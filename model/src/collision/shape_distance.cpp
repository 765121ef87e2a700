#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <optional>
#include <span>
#include <variant>

#include "collision/convex_shape_data.hpp"
#include "collision/exact_search.hpp"
#include "collision/gjk_filter.hpp"
#include "collision/nearest_face.hpp"
#include "collision/posed_hulls.hpp"
#include "fringe/convex_shape.hpp"
#include "fringe/error.hpp"
#include "simd/dispatch.hpp"

namespace fringe {
namespace {

using detail::SupportShape;
using Eigen::Isometry3d;
using Eigen::Vector3d;

/// Difference between the upper and lower bound, relative to the distance, at which the iteration has
/// converged.
constexpr double most_doubt = 1e-12;

/// Bound on the error of a point of the Minkowski difference and of its product with a unit vector, relative
/// to the extent.
constexpr double relative_error = 0x1p-47;

struct Posed {
  const ConvexShape& shape;
  const Isometry3d& pose;

  const SupportShape& support() const { return shape.data().support; }

  Vector3d farthest_along(const Vector3d& direction) const {
    const Vector3d local = pose.linear().transpose() * direction;
    Vector3d point;
    detail::best_kernels<detail::GjkFilter>().support(support(), local.data(), point.data());
    return point;
  }
};

/// A simplex of the Minkowski difference A − B, and its point nearest to the origin.
class NearestSimplex {
 public:
  NearestSimplex(const Posed& a, const Posed& b)
      : a_(a), b_(b), offset_(a.pose.translation() - b.pose.translation()) {}

  const Vector3d& nearest() const { return nearest_; }
  const Vector3d& offset() const { return offset_; }
  bool is_tetrahedron() const { return simplex_.size == 4; }
  const PointSimplex& simplex() const { return simplex_; }

  Vector3d difference(const PointPair& pair) const {
    return a_.pose.linear() * pair.a + offset_ - b_.pose.linear() * pair.b;
  }

  /// Adds a point and reduces the simplex to the face nearest to the origin. Returns false if rounding hides
  /// which face that is, or if the point is in the simplex already.
  bool add(const PointPair& pair) {
    const auto known = std::span(simplex_.pairs).first(simplex_.size);
    if (std::ranges::any_of(known, [&](const PointPair& own) { return own.a == pair.a && own.b == pair.b; }))
      return false;
    points_[simplex_.size] = difference(pair);
    simplex_.pairs[simplex_.size++] = pair;
    const auto product = [&](std::size_t i, std::size_t j, std::size_t k) {
      return points_[i].dot(points_[j] - points_[k]);
    };
    const auto face = detail::nearest_face<double>(product, simplex_.size);
    if (!face) {
      --simplex_.size;
      return false;
    }
    keep(*face);
    return true;
  }

  /// Returns the witness points in the world: the points of the shapes whose difference is the nearest point.
  PointPair witnesses() const {
    PointPair sum{Vector3d::Zero(), Vector3d::Zero()};
    for (std::size_t i = 0; i < simplex_.size; ++i) {
      sum.a += shares_[i] * simplex_.pairs[i].a;
      sum.b += shares_[i] * simplex_.pairs[i].b;
    }
    return {a_.pose * sum.a, b_.pose * sum.b};
  }

 private:
  /// Reduces the simplex to a face and computes the face's point nearest to the origin.
  void keep(const detail::NearestFace<double>& face) {
    double total = 0;
    std::size_t kept = 0;
    for (std::size_t i = 0; i < simplex_.size; ++i)
      if (detail::holds(face.members, i)) {
        simplex_.pairs[kept] = simplex_.pairs[i];
        points_[kept] = points_[i];
        shares_[kept++] = face.weights[i];
        total += face.weights[i];
      }
    simplex_.size = kept;
    nearest_.setZero();
    for (std::size_t i = 0; i < kept; ++i) {
      shares_[i] /= total;
      nearest_ += shares_[i] * points_[i];
    }
  }

  Posed a_, b_;
  Vector3d offset_;
  PointSimplex simplex_;
  std::array<Vector3d, 4> points_;
  std::array<double, 4> shares_{};
  Vector3d nearest_ = Vector3d::Zero();
};

struct FloatDistance {
  ShapeDistance found;
  bool is_closed;  ///< whether the bounds differ by no more than most_doubt
  PointSimplex simplex;
};

/// Runs the iteration of Gilbert, Johnson and Keerthi until its bounds meet or rounding stops it.
FloatDistance search_in_floating_point(const Posed& a, const Posed& b, double extent) {
  NearestSimplex simplex(a, b);
  ShapeDistance found{extent, 0, Vector3d::Zero(), a.pose.translation(), b.pose.translation(), false};
  const double error = relative_error * extent;
  Vector3d direction = simplex.offset().isZero(0) ? Vector3d::UnitX() : Vector3d(-simplex.offset());
  const auto farthest = [&] { return PointPair{a.farthest_along(direction), b.farthest_along(-direction)}; };
  simplex.add(farthest());
  // Polytopes take about ten iterations, round shapes thirty.
  constexpr int most_rounds = 100;
  for (int round = 0; round < most_rounds; ++round) {
    const double length = simplex.nearest().norm();
    if (simplex.is_tetrahedron() || length <= error || (round > 0 && length >= found.distance))
      break;
    const auto [on_a, on_b] = simplex.witnesses();
    found.distance = length, found.witness_a = on_a, found.witness_b = on_b;
    direction = -simplex.nearest() / length;
    const PointPair pair = farthest();
    const double bound = -simplex.difference(pair).dot(direction) - error;
    if (bound > found.lower_bound)
      found.lower_bound = std::min(bound, length), found.direction = direction;
    if (length + error - found.lower_bound <= most_doubt * length)
      return {found, true, simplex.simplex()};
    if (!simplex.add(pair))
      break;
  }
  return {found, false, simplex.simplex()};
}

/// Converts a simplex of points to the indices of its vertices.
PairSimplex indices_of(const PointSimplex& points, const ConvexShape& a, const ConvexShape& b) {
  const auto index_of = [](const ConvexShape& shape, const Vector3d& point) {
    const auto& vertices = shape.data().vertices;
    return static_cast<std::size_t>(std::find(vertices.begin(), vertices.end(), point) - vertices.begin());
  };
  PairSimplex simplex;
  for (std::size_t i = 0; i < points.size; ++i)
    simplex.pairs[simplex.size++] = {index_of(a, points.pairs[i].a), index_of(b, points.pairs[i].b)};
  return simplex;
}

/// Computes the distance of two polytopes in integers.
ShapeDistance solve_in_integers(const Posed& a, const Posed& b, const PointSimplex& start) {
  const detail::PosedHulls hulls(a.shape, a.pose, b.shape, b.pose);
  const detail::ExactNearest nearest =
      detail::exact_search(hulls.exact(), indices_of(start, a.shape, b.shape), detail::Goal::distance);
  const HullDistance solved = detail::rounded_distance(hulls.exact(), nearest);
  const Vector3d direction = detail::direction_of(detail::negated(nearest.point)).stableNormalized();
  constexpr double rounded_down = 1 - 0x1p-50;
  return {
      solved.distance, solved.distance * rounded_down, direction, solved.witness_a, solved.witness_b, true};
}

/// Returns the distance of shapes that meet: zero, with the common point that the certificate names, as a
/// point of each shape.
ShapeDistance meeting(const ShapeAnswer& answer, const Posed& a, const Posed& b) {
  const auto* meet = std::get_if<ShapesMeet>(&answer.certificate);
  const PointSimplex& shared = meet ? meet->simplex : std::get<ShapesUndecided>(answer.certificate).simplex;
  NearestSimplex simplex(a, b);
  for (std::size_t i = 0; i < shared.size; ++i)
    simplex.add(shared.pairs[i]);
  const auto [on_a, on_b] = simplex.witnesses();
  return {0, 0, Vector3d::Zero(), on_a, on_b, false};
}

}  // namespace

ShapeDistance gjk_distance(const ConvexShape& a, const Isometry3d& pose_a, const ConvexShape& b,
                           const Isometry3d& pose_b) {
  if (!pose_a.matrix().allFinite() || !pose_b.matrix().allFinite())
    throw InputError("a pose must be finite");
  const Posed posed_a{a, pose_a}, posed_b{b, pose_b};
  const bool is_flat = !a.is_round() && !b.is_round();
  const double extent = (pose_a.translation() - pose_b.translation()).lpNorm<1>() + a.data().support.reach +
                        b.data().support.reach;
  if (!(extent < 0x1p170 && extent > 0x1p-170)) {
    if (is_flat)
      return solve_in_integers(posed_a, posed_b, {});
    throw InputError("round shapes must be of a size and distance within 2^-170 and 2^170");
  }
  const FloatDistance reached = search_in_floating_point(posed_a, posed_b, extent);
  if (reached.is_closed)
    return reached.found;
  const ShapeAnswer answer = gjk_intersects(a, pose_a, b, pose_b);
  if (answer.intersects) {
    ShapeDistance shared = meeting(answer, posed_a, posed_b);
    // Where faces touch, rounding may have made the simplex miss the common point.
    if (!is_flat || (shared.witness_a - shared.witness_b).norm() <= relative_error * extent)
      return shared;
  }
  return is_flat ? solve_in_integers(posed_a, posed_b, reached.simplex) : reached.found;
}

}  // namespace fringe
