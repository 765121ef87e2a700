#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>
#include <vector>

#include "collision/convex_shape_data.hpp"
#include "collision/rational_vector.hpp"
#include "fringe/convex_shape.hpp"

/// Verifies certificates of shapes with nothing but the given numbers and rational arithmetic.
namespace fringe {
namespace {

using detail::Form;
using detail::Rational;
using detail::RationalVector;
using detail::SupportShape;
using Eigen::Isometry3d;
using Eigen::Vector3d;

/// A shape and its pose in rational numbers.
struct RationalShape {
  const ConvexShape& shape;
  std::array<RationalVector, 3> columns;
  RationalVector translation;

  RationalShape(const ConvexShape& form, const Isometry3d& pose)
      : shape(form), columns{detail::rational(pose.linear().col(0)), detail::rational(pose.linear().col(1)),
                             detail::rational(pose.linear().col(2))},
        translation(detail::rational(pose.translation())) {}

  RationalVector moved(const RationalVector& point) const {
    RationalVector result = translation;
    for (std::size_t k = 0; k < 3; ++k)
      result = detail::plus(result, detail::times(point[k], columns[k]));
    return result;
  }

  /// Turns a direction of the world into the shape's frame, by the transposed matrix: products with points
  /// change by the translation's product only.
  RationalVector turned_back(const RationalVector& direction) const {
    return {detail::product(columns[0], direction), detail::product(columns[1], direction),
            detail::product(columns[2], direction)};
  }
};

/// Returns an upper bound of the square root, above it by less than 2^−200 of it.
Rational root_from_above(const Rational& square) {
  if (square.is_zero())
    return 0;
  using Integer = boost::multiprecision::cpp_int;
  const Integer numerator = boost::multiprecision::numerator(square),
                denominator = boost::multiprecision::denominator(square);
  // √(n/d) = √(n·d)/d.
  constexpr unsigned extra_bits = 200;
  const Integer root = sqrt(Integer((numerator * denominator) << (2 * extra_bits)));
  return {Integer(root + 1), Integer(denominator << extra_bits)};
}

/// Returns an upper bound of the support function: of the product of the direction with any point of a shape,
/// in its own frame. It exceeds the largest product by less than 2^−200.
Rational height_from_above(const ConvexShape& shape, const RationalVector& direction) {
  const SupportShape& form = shape.data().support;
  const Rational radius(form.size[0]), half_height(form.size[1]);
  const Rational flat = direction[0] * direction[0] + direction[1] * direction[1];
  const Rational upright = abs(direction[2]);
  switch (form.form) {
  case Form::ball:
    return radius * root_from_above(flat + upright * upright);
  case Form::cylinder:
    return radius * root_from_above(flat) + half_height * upright;
  case Form::cone: {
    const Rational apex = half_height * direction[2];
    return std::max<Rational>(apex, radius * root_from_above(flat) - apex);
  }
  case Form::sector: {
    const RationalVector first{Rational(form.ends[0]), Rational(form.ends[1]), Rational(0)},
        second{Rational(form.ends[2]), Rational(form.ends[3]), Rational(0)};
    const Rational inner(form.size[2]);
    const Rational at_first = detail::product(first, direction),
                   at_second = detail::product(second, direction);
    Rational highest = std::max<Rational>(std::max<Rational>(radius * at_first, inner * at_first),
                                          std::max<Rational>(radius * at_second, inner * at_second));
    if (first[0] * direction[1] >= first[1] * direction[0] &&
        direction[0] * second[1] >= direction[1] * second[0])
      highest = std::max<Rational>(highest, radius * root_from_above(flat));
    return highest + half_height * upright;
  }
  case Form::box:
  case Form::hull:
    break;
  }
  std::optional<Rational> highest;
  for (const Vector3d& vertex : shape.data().vertices) {
    const Rational height = detail::product(direction, detail::rational(vertex));
    if (!highest || height > *highest)
      highest = height;
  }
  return highest.value();
}

/// Returns an upper bound of max direction·a − min direction·b over the points a and b of the moved shapes.
Rational overlap_from_above(const RationalVector& direction, const RationalShape& a, const RationalShape& b) {
  const RationalVector against = detail::times(-1, direction);
  return height_from_above(a.shape, a.turned_back(direction)) +
         height_from_above(b.shape, b.turned_back(against)) +
         detail::product(direction, detail::minus(a.translation, b.translation));
}

/// Tests whether a point in the shape's own frame belongs to it; for a hull, whether it is one of the
/// vertices.
bool holds(const ConvexShape& shape, const Vector3d& point) {
  if (!point.allFinite())
    return false;
  const SupportShape& form = shape.data().support;
  const RationalVector p = detail::rational(point);
  const Rational radius(form.size[0]), half_height(form.size[1]);
  const Rational flat = p[0] * p[0] + p[1] * p[1];
  switch (form.form) {
  case Form::ball:
    return flat + p[2] * p[2] <= radius * radius;
  case Form::cylinder:
    return flat <= radius * radius && abs(p[2]) <= half_height;
  case Form::cone: {
    const Rational below_apex = half_height - p[2];
    return abs(p[2]) <= half_height &&
           4 * half_height * half_height * flat <= radius * radius * below_apex * below_apex &&
           flat <= radius * radius;
  }
  case Form::sector: {
    const Rational x(form.ends[0]), y(form.ends[3]), inner(form.size[2]);
    return flat <= radius * radius && abs(p[2]) <= half_height && abs(p[1]) * x <= y * p[0] &&
           p[0] >= inner * x;
  }
  case Form::box:
    return (point.cwiseAbs().array() <= Vector3d(form.size).array()).all();
  case Form::hull:
    break;
  }
  return std::find(shape.data().vertices.begin(), shape.data().vertices.end(), point) !=
         shape.data().vertices.end();
}

/// Returns the differences of the moved points; no points if one of them does not belong to its shape.
std::vector<RationalVector> points_of(const PointSimplex& simplex, const RationalShape& a,
                                      const RationalShape& b) {
  std::vector<RationalVector> points;
  for (std::size_t i = 0; i < std::min(simplex.size, simplex.pairs.size()); ++i) {
    const PointPair& pair = simplex.pairs[i];
    if (!holds(a.shape, pair.a) || !holds(b.shape, pair.b))
      return {};
    points.push_back(detail::minus(a.moved(detail::rational(pair.a)), b.moved(detail::rational(pair.b))));
  }
  return points;
}

bool proves_separation(const RationalVector& direction, const RationalShape& a, const RationalShape& b) {
  return overlap_from_above(direction, a, b) < 0;
}

}  // namespace

bool proves(const ShapeAnswer& answer, const ConvexShape& a, const Isometry3d& pose_a, const ConvexShape& b,
            const Isometry3d& pose_b) {
  const RationalShape moved_a(a, pose_a), moved_b(b, pose_b);
  if (const auto* separated = std::get_if<ShapesSeparated>(&answer.certificate))
    return !answer.intersects && separated->direction.allFinite() &&
           proves_separation(detail::rational(separated->direction), moved_a, moved_b);
  if (const auto* separated = std::get_if<ShapesSeparatedBySimplex>(&answer.certificate)) {
    const std::vector<RationalVector> points = points_of(separated->simplex, moved_a, moved_b);
    return !answer.intersects && !points.empty() && points.size() <= 3 &&
           proves_separation(detail::times(-1, detail::towards_nearest(points)), moved_a, moved_b);
  }
  if (const auto* meet = std::get_if<ShapesMeet>(&answer.certificate))
    return answer.intersects && detail::hull_holds_origin(points_of(meet->simplex, moved_a, moved_b));
  const auto& undecided = std::get<ShapesUndecided>(answer.certificate);
  const std::vector<RationalVector> points = points_of(undecided.simplex, moved_a, moved_b);
  if (!answer.intersects || points.empty() || !undecided.direction.allFinite() ||
      !std::isfinite(undecided.overlap) || !std::isfinite(undecided.gap))
    return false;
  const Rational gap(undecided.gap);
  return overlap_from_above(detail::rational(undecided.direction), moved_a, moved_b) <=
             Rational(undecided.overlap) &&
         detail::squared_distance_to_origin(points) <= gap * gap;
}

}  // namespace fringe
