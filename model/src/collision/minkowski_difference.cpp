#include "collision/minkowski_difference.hpp"

#include <algorithm>
#include <cmath>

namespace fringe::detail {
namespace {

using Eigen::Vector3d;

/// Finds a vertex farthest along a direction of the world. Only vertices whose rounded products are within
/// the error bound of the largest are compared exactly.
Vector3d exactly_farthest(const PlacedConvex& polytope, const ExactPlacement& exact, const ConvexPair& pair,
                          const Vector<Dyadic>& direction) {
  const Vector3d rounded = direction_of(direction);
  const Vector3d turned = polytope.pose->linear().transpose() * rounded;
  const auto product = [&](const Vector3d& vertex) { return (vertex - polytope.origin).dot(turned); };
  double threshold = -std::numeric_limits<double>::infinity();
  if (pair.is_in_safe_range())
    threshold = product(polytope.farthest_along(rounded)) - 2 * pair.rounding() * rounded.lpNorm<1>();
  const Vector<Dyadic> exactly_turned = exact.turned_back(direction);
  const Vector3d* farthest = nullptr;
  Dyadic largest;
  for (const Vector3d& vertex : polytope.vertices) {
    // Written so that a NaN is compared exactly.
    if (product(vertex) < threshold)
      continue;
    Dyadic exact_product = exactly_turned.dot(vertex.cast<Dyadic>());
    if (farthest == nullptr || exact_product > largest) {
      farthest = &vertex;
      largest = std::move(exact_product);
    }
  }
  return *farthest;
}

/// Returns a point inside a round shape, towards which points of its surface are moved.
Vector3d inner_point(const SupportShape& shape) {
  if (shape.kind != ShapeKind::sector)
    return Vector3d::Zero();
  return {(shape.size[0] + shape.size[2] * shape.ends[0]) / 2, 0, 0};
}

/// Moves a rounded point of a shape inwards so far that it certainly belongs to the shape; vertices stay
/// where they are.
Vector3d moved_inwards(const PlacedConvex& placed, const Vector3d& point) {
  if (!placed.is_round())
    return point;
  constexpr double least_share = 0x1p-48;
  const SupportShape& shape = *placed.shape;
  double share = least_share;
  if (shape.kind == ShapeKind::sector && shape.size[0] != 0) {
    // The inner point of a thin piece is close to its flat sides, so the fraction must be larger.
    const double thickness = (shape.size[0] - shape.size[2] * shape.ends[0]) / shape.size[0];
    share = std::min(1.0, least_share / std::min(thickness, shape.ends[3]));
  } else if (shape.kind == ShapeKind::rounded_box || shape.kind == ShapeKind::ellipsoid) {
    // So must that of a long one: the inner point is as far from the surface as the shape is thick.
    const double rounding = shape.kind == ShapeKind::rounded_box ? shape.ends[0] : 0;
    const double inner_radius = *std::min_element(shape.size, shape.size + 3) + rounding;
    share = std::min(1.0, least_share * shape.bounding_radius / inner_radius);
  }
  return point + share * (inner_point(shape) - point);
}

}  // namespace

ExactPlacement::ExactPlacement(const Eigen::Isometry3d& pose)
    : in_place(pose.matrix() == Eigen::Matrix4d::Identity()), rotation(pose.linear().cast<Dyadic>()),
      translation(pose.translation().cast<Dyadic>()) {}

Vector<Dyadic> ExactPlacement::position(const Vector3d& point) const {
  const Vector<Dyadic> exact = point.cast<Dyadic>();
  return in_place ? exact : Vector<Dyadic>(rotation * exact + translation);
}

Vector<Dyadic> ExactPlacement::turned_back(const Vector<Dyadic>& direction) const {
  return in_place ? direction : Vector<Dyadic>(rotation.transpose() * direction);
}

ExactDifference::ExactDifference(const ConvexPair& pair) : pair_(pair), a_(*pair.a.pose), b_(*pair.b.pose) {}

GjkDistance ExactDifference::distance(const NearestFace<Dyadic>& face) const {
  Vector<Dyadic> sum_a = Vector<Dyadic>::Zero(), sum_b = sum_a;
  for (std::size_t i = 0; i < face.simplex.size; ++i) {
    sum_a += face.weights[i] * a_.position(face.simplex.pairs[i].a);
    sum_b += face.weights[i] * b_.position(face.simplex.pairs[i].b);
  }
  const auto divided = [&](const Vector<Dyadic>& sum) -> Vector3d {
    return {rounded_quotient(sum.x(), face.total), rounded_quotient(sum.y(), face.total),
            rounded_quotient(sum.z(), face.total)};
  };
  const double length = rounded_root_quotient(face.nearest.squaredNorm(), face.total);
  constexpr double rounded_down = 1 - 0x1p-50;
  const double bound = std::min(length, std::numeric_limits<double>::max()) * rounded_down;
  return {length,         bound,          direction_of(-face.nearest).stableNormalized(),
          divided(sum_a), divided(sum_b), true};
}

std::optional<PointPair> PolytopeDifference::next_pair(const NearestFace<Dyadic>& face) const {
  const Dyadic square = face.nearest.squaredNorm();
  if (square.sign() == 0)
    return std::nullopt;
  const PointPair pair = farthest_along(-face.nearest);
  const Dyadic least = face.nearest.dot(point(pair));
  if (goal_ == Goal::decision ? least.sign() > 0 : face.total * least >= square)
    return std::nullopt;
  return pair;
}

bool PolytopeDifference::separates(const Vector3d& direction) const {
  const Vector<Dyadic> exact = direction.cast<Dyadic>();
  return point(farthest_along(exact)).dot(exact).sign() < 0;
}

PointPair PolytopeDifference::farthest_along(const Vector<Dyadic>& direction) const {
  return {exactly_farthest(pair_.a, a_, pair_, direction), exactly_farthest(pair_.b, b_, pair_, -direction)};
}

PointPair RoundDifference::inside(const PointPair& pair) const {
  return {moved_inwards(pair_.a, pair.a), moved_inwards(pair_.b, pair.b)};
}

std::optional<PointPair> RoundDifference::next_pair(const NearestFace<Dyadic>& face) {
  // About twenty rounds are needed where the shapes nearly touch. A pair still open after this many is
  // undecided.
  constexpr int most_rounds = 300;
  // Bounds the error of a support value, as in the filter, plus the displacement of points moved inwards.
  const double error = 0x1p-45 * pair_.extent;
  const double distance = rounded_root_quotient(face.nearest.squaredNorm(), face.total);
  if (distance == 0) {
    answer_ = {true, SimplexAroundOrigin{face.simplex}};
    return std::nullopt;
  }
  const Vector3d direction = direction_of(-face.nearest).normalized();
  const PointPair pair = pair_.farthest_along(direction);
  const double overlap = pair_.difference(pair).dot(direction);
  if (overlap < -error) {
    answer_ = {false, SeparatingDirection{direction}};
    return std::nullopt;
  }
  hidden_.gap = distance * (1 + 0x1p-50);
  hidden_.simplex = face.simplex;
  if (overlap + error < hidden_.overlap) {
    hidden_.overlap = overlap + error;
    hidden_.direction = direction;
  }
  if (overlap <= error - distance || ++round_ == most_rounds) {
    answer_ = {true, hidden_};
    return std::nullopt;
  }
  return inside(pair);
}

}  // namespace fringe::detail
