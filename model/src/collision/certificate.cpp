#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <vector>

#include <Eigen/LU>
#include <boost/multiprecision/cpp_int.hpp>
#include <boost/operators.hpp>

#include "collision/convex_shape_data.hpp"
#include "fringe/convex_shape.hpp"

/// Verifies certificates with nothing but the given numbers and rational arithmetic.
namespace fringe {
namespace {

using detail::ShapeKind;
using detail::SupportShape;
using Eigen::Isometry3d;
using Eigen::Vector3d;
using Vertices = std::span<const Vector3d>;

/// A rational number, in a form that Eigen's vectors take.
struct Rational : boost::ordered_field_operators<Rational> {
  boost::multiprecision::cpp_rational value;

  Rational(double number = 0) : value(number) {}
  Rational& operator+=(const Rational& other) { return value += other.value, *this; }
  Rational& operator-=(const Rational& other) { return value -= other.value, *this; }
  Rational& operator*=(const Rational& other) { return value *= other.value, *this; }
  Rational& operator/=(const Rational& other) { return value /= other.value, *this; }
  Rational operator-() const { return Rational() - *this; }
  friend bool operator<(const Rational& a, const Rational& b) { return a.value < b.value; }
  friend bool operator==(const Rational& a, const Rational& b) { return a.value == b.value; }
};

Rational abs(const Rational& number) {
  return number < 0 ? -number : number;
}

using RationalVector = Eigen::Matrix<Rational, 3, 1>;
using RationalMatrix = Eigen::Matrix<Rational, 3, 3>;

RationalVector rational(const Vector3d& point) {
  return point.cast<Rational>();
}

/// A shape and its pose in rational numbers.
struct RationalShape {
  const SupportShape& shape;
  Vertices vertices;  ///< a polytope's
  RationalMatrix rotation;
  RationalVector translation;

  RationalShape(const SupportShape& support, Vertices corners, const Isometry3d& pose)
      : shape(support), vertices(corners), rotation(pose.linear().cast<Rational>()),
        translation(pose.translation().cast<Rational>()) {}

  RationalVector moved(const Vector3d& point) const { return rotation * rational(point) + translation; }
};

/// Returns an upper bound of the square root, above it by less than 2^−200 of it.
Rational root_from_above(const Rational& square) {
  if (square == 0)
    return 0;
  using Integer = boost::multiprecision::cpp_int;
  const Integer numerator = boost::multiprecision::numerator(square.value),
                denominator = boost::multiprecision::denominator(square.value);
  // √(n/d) = √(n·d)/d.
  constexpr unsigned extra_bits = 200;
  const Integer root = sqrt(Integer((numerator * denominator) << (2 * extra_bits)));
  Rational above;
  above.value = {Integer(root + 1), Integer(denominator << extra_bits)};
  return above;
}

/// Returns an upper bound of the support function: of the product of the direction with any point of a shape,
/// in its own frame. It exceeds the largest product by less than 2^−200.
Rational height_from_above(const RationalShape& placed, const RationalVector& direction) {
  const SupportShape& shape = placed.shape;
  const Rational radius(shape.size[0]), half_height(shape.size[1]);
  const Rational flat = direction.head<2>().squaredNorm();
  const Rational upright = abs(direction.z());
  switch (shape.kind) {
  case ShapeKind::ball:
    return radius * root_from_above(direction.squaredNorm());
  case ShapeKind::cylinder:
    return radius * root_from_above(flat) + half_height * upright;
  case ShapeKind::cone: {
    const Rational apex = half_height * direction.z();
    return std::max(apex, radius * root_from_above(flat) - apex);
  }
  case ShapeKind::sector: {
    const RationalVector first = rational({shape.ends[0], shape.ends[1], 0}),
                         second = rational({shape.ends[2], shape.ends[3], 0});
    const Rational at_first = first.dot(direction), at_second = second.dot(direction), inner(shape.size[2]);
    Rational highest = std::max({radius * at_first, inner * at_first, radius * at_second, inner * at_second});
    if (first.cross(direction).z() >= 0 && direction.cross(second).z() >= 0)
      highest = std::max(highest, radius * root_from_above(flat));
    return highest + half_height * upright;
  }
  case ShapeKind::rounded_box:
    return rational(Vector3d(shape.size)).dot(direction.unaryExpr(&abs)) +
           Rational(shape.ends[0]) * root_from_above(direction.squaredNorm());
  case ShapeKind::ellipsoid:
    return root_from_above(rational(Vector3d(shape.size)).cwiseProduct(direction).squaredNorm());
  case ShapeKind::box:
  case ShapeKind::hull:
    break;
  }
  std::optional<Rational> highest;
  for (const Vector3d& vertex : placed.vertices) {
    const Rational height = direction.dot(rational(vertex));
    if (!highest || height > *highest)
      highest = height;
  }
  return highest.value();
}

/// Returns an upper bound of max direction·a − min direction·b over the points a and b of the moved shapes.
Rational overlap_from_above(const RationalVector& direction, const RationalShape& a, const RationalShape& b) {
  // Turned by the transposed matrix, the direction's products with a shape's own points are those with the
  // rotated points.
  return height_from_above(a, a.rotation.transpose() * direction) +
         height_from_above(b, b.rotation.transpose() * -direction) +
         direction.dot(a.translation - b.translation);
}

/// Tests whether a point in the shape's own frame belongs to it; for a hull, whether it is one of the
/// vertices.
bool contains(const RationalShape& placed, const Vector3d& point) {
  if (!point.allFinite())
    return false;
  const SupportShape& shape = placed.shape;
  const RationalVector p = rational(point);
  const Rational radius(shape.size[0]), half_height(shape.size[1]);
  const Rational flat = p.head<2>().squaredNorm();
  switch (shape.kind) {
  case ShapeKind::ball:
    return p.squaredNorm() <= radius * radius;
  case ShapeKind::cylinder:
    return flat <= radius * radius && abs(p.z()) <= half_height;
  case ShapeKind::cone: {
    const Rational below_apex = half_height - p.z();
    return abs(p.z()) <= half_height &&
           4 * half_height * half_height * flat <= radius * radius * below_apex * below_apex &&
           flat <= radius * radius;
  }
  case ShapeKind::sector: {
    const Rational x(shape.ends[0]), y(shape.ends[3]), inner(shape.size[2]);
    return flat <= radius * radius && abs(p.z()) <= half_height && abs(p.y()) * x <= y * p.x() &&
           p.x() >= inner * x;
  }
  case ShapeKind::rounded_box: {
    Rational square;
    for (Eigen::Index i = 0; i < 3; ++i) {
      const Rational beside = std::max(Rational(), abs(p[i]) - Rational(shape.size[i]));
      square += beside * beside;
    }
    return square <= Rational(shape.ends[0]) * Rational(shape.ends[0]);
  }
  case ShapeKind::ellipsoid:
    return p.cwiseQuotient(rational(Vector3d(shape.size))).squaredNorm() <= 1;
  case ShapeKind::box:
    return (point.cwiseAbs().array() <= Vector3d(shape.size).array()).all();
  case ShapeKind::hull:
    break;
  }
  return std::find(placed.vertices.begin(), placed.vertices.end(), point) != placed.vertices.end();
}

/// Returns the differences of the moved points; no points if one of them does not belong to its shape.
std::vector<RationalVector> points_of(const Simplex& simplex, const RationalShape& a,
                                      const RationalShape& b) {
  std::vector<RationalVector> points;
  for (std::size_t i = 0; i < std::min(simplex.size, simplex.pairs.size()); ++i) {
    const PointPair& pair = simplex.pairs[i];
    if (!contains(a, pair.a) || !contains(b, pair.b))
      return {};
    points.emplace_back(a.moved(pair.a) - b.moved(pair.b));
  }
  return points;
}

/// The point nearest to the origin on the line, plane or space through points.
struct Foot {
  RationalVector point;
  bool is_inside;  ///< whether it is a convex combination of the points
};

/// Finds the foot of the origin by the normal equations of the edges from the first point; nothing if the
/// points, at most four, are affinely dependent.
std::optional<Foot> foot_of_origin(const std::vector<RationalVector>& points) {
  RationalMatrix edges = RationalMatrix::Zero(), gram = RationalMatrix::Identity();
  const auto count = static_cast<Eigen::Index>(points.size()) - 1;
  for (Eigen::Index i = 0; i < count; ++i)
    edges.col(i) = points[static_cast<std::size_t>(i) + 1] - points[0];
  for (Eigen::Index i = 0; i < count; ++i)
    for (Eigen::Index j = 0; j < count; ++j)
      gram(i, j) = edges.col(i).dot(edges.col(j));
  if (gram.determinant() == 0)
    return std::nullopt;
  const RationalVector shares = gram.inverse() * (edges.transpose() * -points[0]);
  const bool is_inside = shares.x() >= 0 && shares.y() >= 0 && shares.z() >= 0 && shares.sum() <= 1;
  return Foot{points[0] + edges * shares, is_inside};
}

/// Computes the squared distance from the origin to the hull of one to four points: the least of the feet
/// inside their faces, among which the affinely independent ones suffice by Carathéodory's theorem.
Rational squared_distance_to_origin(const std::vector<RationalVector>& points) {
  Rational least = points[0].squaredNorm();
  for (unsigned subset = (1U << points.size()) - 1; subset > 0 && !(least == 0); --subset) {
    std::vector<RationalVector> face;
    for (std::size_t i = 0; i < points.size(); ++i)
      if (((subset >> i) & 1U) != 0)
        face.push_back(points[i]);
    const std::optional<Foot> foot = foot_of_origin(face);
    if (foot && foot->is_inside)
      least = std::min(least, foot->point.squaredNorm());
  }
  return least;
}

bool separates(const RationalVector& direction, const RationalShape& a, const RationalShape& b) {
  return overlap_from_above(direction, a, b) < 0;
}

bool is_proven(const GjkAnswer& answer, const RationalShape& a, const RationalShape& b) {
  if (const auto* separating = std::get_if<SeparatingDirection>(&answer.certificate))
    return !answer.intersects && separating->direction.allFinite() &&
           separates(rational(separating->direction), a, b);
  if (const auto* separating = std::get_if<SeparatingSimplex>(&answer.certificate)) {
    const std::vector<RationalVector> points = points_of(separating->simplex, a, b);
    if (answer.intersects || points.empty() || points.size() > 3)
      return false;
    const std::optional<Foot> foot = foot_of_origin(points);
    return foot && separates(-foot->point, a, b);
  }
  if (const auto* around = std::get_if<SimplexAroundOrigin>(&answer.certificate)) {
    const std::vector<RationalVector> points = points_of(around->simplex, a, b);
    return answer.intersects && !points.empty() && squared_distance_to_origin(points) == 0;
  }
  const auto& hidden = std::get<HiddenByRounding>(answer.certificate);
  const std::vector<RationalVector> points = points_of(hidden.simplex, a, b);
  if (!answer.intersects || points.empty() || !hidden.direction.allFinite() ||
      !std::isfinite(hidden.overlap) || !std::isfinite(hidden.gap))
    return false;
  const Rational gap(hidden.gap);
  return overlap_from_above(rational(hidden.direction), a, b) <= Rational(hidden.overlap) &&
         squared_distance_to_origin(points) <= gap * gap;
}

}  // namespace

bool proves(const GjkAnswer& answer, Vertices a, Vertices b) {
  if (a.empty() || b.empty())
    return false;
  const SupportShape hull{};
  const Isometry3d in_place = Isometry3d::Identity();
  return is_proven(answer, RationalShape(hull, a, in_place), RationalShape(hull, b, in_place));
}

bool proves(const GjkAnswer& answer, const ConvexShape& a, const Isometry3d& pose_a, const ConvexShape& b,
            const Isometry3d& pose_b) {
  return is_proven(answer, RationalShape(a.data().support, a.data().vertices, pose_a),
                   RationalShape(b.data().support, b.data().vertices, pose_b));
}

}  // namespace fringe
