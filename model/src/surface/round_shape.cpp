#include "surface/round_shape.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "fringe/triangulation.hpp"

namespace fringe::detail {
namespace {

using Eigen::Vector3d;

/// Least cosine of the angle between a flat part and its plane: curved parts are steeper.
constexpr double same_direction = 1 - 1e-6;

double from_axis(const Vector3d& point) {
  return std::hypot(point.x(), point.y());
}

/// Returns the distance from a point of a part with a centre and a normal to the surface of a shape, in the
/// shape's frame.
struct Depth {
  const Vector3d& centre;
  const Vector3d& normal;
  const Vector3d& point;

  bool is_across_axis() const { return std::abs(normal.z()) > same_direction; }

  double operator()(const Cylinder& cylinder) const {
    return is_across_axis() ? 0 : cylinder.radius - from_axis(point);
  }
  double operator()(const Cone& cone) const {
    if (centre.z() < -cone.height / 2 * same_direction)
      return 0;
    const double radius = cone.radius * (cone.height / 2 - point.z()) / cone.height;
    return (radius - from_axis(point)) * cone.height / std::hypot(cone.height, cone.radius);
  }
  double operator()(const Arc& arc) const {
    const double radius = from_axis(centre);
    const double along = (centre.x() * normal.x() + centre.y() * normal.y()) / radius;
    // The ends of a sector contain the axis.
    if (is_across_axis() || std::abs(along) < 1 - same_direction)
      return 0;
    return (along > 0 ? arc.outer_radius : arc.inner_radius) - from_axis(point);
  }
  double operator()(const Sphere& sphere) const { return sphere.radius - point.norm(); }
  double operator()(const Ellipsoid& ellipsoid) const {
    const Vector3d axes(ellipsoid.semi_axis_x, ellipsoid.semi_axis_y, ellipsoid.semi_axis_z);
    const double level = point.cwiseQuotient(axes).norm();
    return (1 - level) * level / point.cwiseQuotient(axes.cwiseAbs2()).norm();
  }
  double operator()(const Capsule& capsule) const { return of_swept(core_of(capsule), capsule.radius); }
  double operator()(const RoundedCuboid& cuboid) const { return of_swept(core_of(cuboid), cuboid.rounding); }
  template <typename Other>
  double operator()(const Other&) const {
    return 0;
  }

 private:
  double of_swept(const Vector3d& core, double radius) const {
    return radius - (point.cwiseAbs() - core).cwiseMax(0).norm();
  }
};

/// A circle about the axis, at the height of a point, and the regular polygon that stands for it.
struct Circle {
  double radius;
  double size;       ///< of the shape
  double step;       ///< angle between corners of the polygon
  double first = 0;  ///< angle of one of them

  /// Returns how far a point is within the circle.
  double depth(const Vector3d& point) const { return radius - from_axis(point); }

  /// Tells if a chord is no longer than a side of the polygon.
  bool is_along(const Vector3d& from, const Vector3d& to) const {
    constexpr double rounding = 1e-6;
    const double angle = std::atan2(from.x() * to.y() - from.y() * to.x(), from.head<2>().dot(to.head<2>()));
    return std::abs(angle) < (1 + rounding) * step;
  }

  /// Tells if a point lies on the circle or on the polygon.
  bool is_beneath(const Vector3d& point) const {
    constexpr double rounding = 1e-9;
    const double angle = std::remainder(std::atan2(point.y(), point.x()) - first - step / 2, step);
    return std::abs(depth(point)) < rounding * size ||
           std::abs(from_axis(point) * std::cos(angle) - radius * std::cos(step / 2)) < rounding * size;
  }

  Vector3d displacement(const Vector3d& point) const {
    return point.head<2>().isZero(0)
               ? Vector3d(Vector3d::Zero())
               : Vector3d(Vector3d(point.x(), point.y(), 0) * (radius / from_axis(point) - 1));
  }
};

/// Returns the circle nearest to a point of a shape's polyhedron; none for shapes that are not made of
/// circles between rims.
struct NearestCircle {
  const Vector3d& point;

  static double step_of(int segments) { return 2 * std::numbers::pi / segments; }

  std::optional<Circle> operator()(const Disc& disc) const {
    return Circle{disc.radius, disc.radius, step_of(disc.segments)};
  }
  std::optional<Circle> operator()(const Cylinder& cylinder) const {
    return Circle{cylinder.radius, cylinder.radius, step_of(cylinder.segments)};
  }
  std::optional<Circle> operator()(const Cone& cone) const {
    return Circle{cone.radius * (cone.height / 2 - point.z()) / cone.height, cone.radius,
                  step_of(cone.segments)};
  }
  std::optional<Circle> operator()(const Arc& arc) const {
    const double angle = arc.degrees * std::numbers::pi / 180, step = angle / arc.segments;
    const bool is_outer = from_axis(point) > (arc.inner_radius + arc.outer_radius * std::cos(step / 2)) / 2;
    return Circle{is_outer ? arc.outer_radius : arc.inner_radius, arc.outer_radius, step, -angle / 2};
  }
  template <typename Other>
  std::optional<Circle> operator()(const Other&) const {
    return std::nullopt;
  }
};

/// Returns how far a point of the polyhedron has to move to lie on the surface of a shape without rims, in
/// the shape's frame.
struct Displacement {
  const Vector3d& point;

  Vector3d operator()(const Sphere& sphere) const { return of_swept(Vector3d::Zero(), sphere.radius); }
  Vector3d operator()(const Ellipsoid& ellipsoid) const {
    const Vector3d axes(ellipsoid.semi_axis_x, ellipsoid.semi_axis_y, ellipsoid.semi_axis_z);
    return point * (1 / point.cwiseQuotient(axes).norm() - 1);
  }
  Vector3d operator()(const Capsule& capsule) const { return of_swept(core_of(capsule), capsule.radius); }
  Vector3d operator()(const RoundedCuboid& cuboid) const {
    return of_swept(core_of(cuboid), cuboid.rounding);
  }
  template <typename Other>
  Vector3d operator()(const Other&) const {
    return Vector3d::Zero();
  }

 private:
  /// On what a ball sweeps whose centre moves in a box.
  Vector3d of_swept(const Vector3d& core, double radius) const {
    const Vector3d outwards = point - point.cwiseMax(-core).cwiseMin(core);
    return outwards.isZero(0) ? outwards : Vector3d(outwards * (radius / outwards.norm() - 1));
  }
};

/// Tells if each wall of an arc stays clear of the other while its panels move from the polyhedron onto it.
bool are_walls_apart(const Arc& arc) {
  const double step = arc.degrees * std::numbers::pi / 180 / arc.segments;
  return arc.outer_radius - arc.inner_radius > 2 * arc.outer_radius * (1 - std::cos(step / 2));
}

/// Returns an arc with as many segments as keep its walls apart, if these are not too many.
Arc with_walls_apart(Arc arc) {
  /// Largest number of segments, at which the facets themselves hardly differ from the round walls.
  constexpr int most_segments = 360;
  while (arc.segments < most_segments && !are_walls_apart(arc))
    ++arc.segments;
  return arc;
}

}  // namespace

std::optional<RoundShape> RoundShape::of(const Shape& shape, const Eigen::Isometry3d& pose) {
  if (std::holds_alternative<Plate>(shape) || std::holds_alternative<Cuboid>(shape) ||
      std::holds_alternative<Mesh>(shape) || std::holds_alternative<Polygon>(shape))
    return std::nullopt;
  if (const auto* const arc = std::get_if<Arc>(&shape))
    return RoundShape(with_walls_apart(*arc), pose);
  return RoundShape(shape, pose);
}

RoundShape RoundShape::moved(const Eigen::Isometry3d& pose) const {
  RoundShape result = *this;
  result.to_shape_ = to_shape_ * pose.inverse();
  return result;
}

RoundShape RoundShape::in_unit(const Vector3d& origin, double unit) const {
  RoundShape result = *this;
  result.to_shape_ = to_shape_ * Eigen::Translation3d(origin) * Eigen::Scaling(unit);
  result.unit_ = unit_ * unit;
  return result;
}

RoundShape RoundShape::with_fewer_triangles(std::size_t most) const {
  constexpr int least_segments = 8;
  RoundShape result = *this;
  std::visit(
      [&](auto& shape) {
        if constexpr (requires { shape.segments; })
          while (shape.segments > least_segments && triangulate(shape).size() > most)
            shape.segments = std::max(least_segments, shape.segments * 3 / 4);
      },
      result.shape_);
  return result;
}

std::vector<Triangle> RoundShape::triangles() const {
  std::vector<Triangle> result = triangulate(shape_);
  const Eigen::Affine3d to_body = to_shape_.inverse();
  for (Triangle& triangle : result)
    for (Vector3d& corner : triangle)
      corner = to_body * corner;
  return result;
}

bool RoundShape::is_followed() const {
  const auto* const arc = std::get_if<Arc>(&shape_);
  return arc == nullptr || are_walls_apart(*arc);
}

bool RoundShape::is_lack_added() const {
  return !std::holds_alternative<Cylinder>(shape_) && !std::holds_alternative<Cone>(shape_) &&
         !std::holds_alternative<Arc>(shape_);
}

Vector3d RoundShape::on_shape(const Vector3d& point) const {
  /// Displacement over the distance from the shape's centre up to which a point is on the shape already.
  constexpr double rounding = 1e-12;
  const Vector3d place = to_shape_ * point;
  Vector3d way = Vector3d::Zero();
  if (const std::optional<Circle> circle = std::visit(NearestCircle{place}, shape_); !circle)
    way = std::visit(Displacement{place}, shape_);
  else if (circle->is_beneath(place))
    way = circle->displacement(place);
  return way.norm() > rounding * place.norm() ? Vector3d(point + to_shape_.linear().inverse() * way) : point;
}

Vector3d RoundShape::middle(const Vector3d& from, const Vector3d& to) const {
  Vector3d middle = (from + to) / 2;
  const Vector3d start = to_shape_ * from, end = to_shape_ * to, place = (start + end) / 2;
  const std::optional<Circle> at_start = std::visit(NearestCircle{start}, shape_);
  if (!at_start)
    return on_shape(middle);
  const std::optional<Circle> at_end = std::visit(NearestCircle{end}, shape_);
  // An arc has two walls. Longer chords are sides of simplified surfaces, and may cross the face within a
  // rim.
  const bool is_one_wall = !std::holds_alternative<Arc>(shape_) || at_start->radius == at_end->radius;
  if (!is_one_wall || !at_start->is_along(start, end) || !at_start->is_beneath(start) ||
      !at_end->is_beneath(end))
    return middle;
  Circle circle = *at_start;
  circle.radius = (at_start->radius + at_end->radius) / 2;
  return middle + to_shape_.linear().inverse() * circle.displacement(place);
}

std::vector<ConvexPiece> RoundShape::pieces() const {
  const Eigen::Isometry3d from_shape(to_shape_.inverse().matrix());
  std::vector<ConvexPiece> pieces = convex_pieces(shape_).pieces;
  for (ConvexPiece& piece : pieces)
    piece.pose = from_shape * piece.pose;
  return pieces;
}

Eigen::AlignedBox3d RoundShape::box() const {
  const OrientedBox own = enclosing_box(shape_);
  const Eigen::Isometry3d from_shape(to_shape_.inverse().matrix());
  const Vector3d reach = (from_shape.linear() * own.axes.transpose()).cwiseAbs() * own.half_widths;
  const Vector3d centre = from_shape * own.centre;
  return {centre - reach, centre + reach};
}

double RoundShape::greatest_depth(std::span<const Triangle> parts) const {
  double result = 0;
  for (const Triangle& part : parts) {
    const Triangle own{to_shape_ * part[0], to_shape_ * part[1], to_shape_ * part[2]};
    const Vector3d centre = centre_of(own), normal = unit_normal(own);
    const std::array<Vector3d, 3> middles = middles_of_sides(own);
    for (const Vector3d& point : {centre, middles[0], middles[1], middles[2]})
      result = std::max(result, std::abs(std::visit(Depth{centre, normal, point}, shape_)));
  }
  return result / unit_;
}

double RoundShape::depth(const Triangle& part) const {
  double sum = 0;
  // The depth of a facet is of the second degree, but for cones: the middles of the sides have its mean.
  for (const auto& [from, over, to] : quarters(part)) {
    const Vector3d a = to_shape_ * from, b = to_shape_ * over, c = to_shape_ * to;
    const Vector3d centre = centre_of({a, b, c}), normal = unit_normal({a, b, c});
    for (const Vector3d& point : {Vector3d((a + b) / 2), Vector3d((b + c) / 2), Vector3d((c + a) / 2)})
      sum += std::abs(std::visit(Depth{centre, normal, point}, shape_));
  }
  return sum / 12 / unit_;
}

double RoundShape::lack_per_squared_charge(const Panel& panel) const {
  constexpr double pi = std::numbers::pi;
  const auto* const disc = std::get_if<Disc>(&shape_);
  if (disc == nullptr)
    return 4 * pi * depth(panel.corners) / panel.area;
  // At the rim the density of both sides together is k/√distance, and the capacitance rises by 2π²·k² times
  // the area that is added. A panel with a side on the rim, of area A, has the charge k·A·(8/3)/√(its
  // height).
  double sum = 0;
  const Circle rim = *NearestCircle{panel.centre}(*disc);
  for (std::size_t side = 0; side < 3; ++side) {
    const Vector3d from = to_shape_ * panel.corners[side], to = to_shape_ * panel.corners[(side + 1) % 3];
    if (rim.is_beneath(from) && rim.is_beneath(to))
      sum += (rim.depth(from) + 4 * rim.depth((from + to) / 2) + rim.depth(to)) / 6;
  }
  return 9 * pi * pi / 16 * sum / unit_ / panel.area;
}

double RoundShape::lack_along_rim(const Panel& panel, double largest_charge) const {
  constexpr double pi = std::numbers::pi;
  const auto& [a, b, c] = panel.corners;
  const Vector3d normal = to_shape_.linear() * (b - a).cross(c - a);
  if (is_lack_added() || std::abs(normal.z()) < same_direction * normal.norm() || largest_charge == 0)
    return 0;
  double result = 0;
  for (std::size_t side = 0; side < 3; ++side) {
    const Vector3d &from = panel.corners[side], &to = panel.corners[(side + 1) % 3];
    const Vector3d start = to_shape_ * from, end = to_shape_ * to;
    const Circle circle = *std::visit(NearestCircle{start}, shape_);
    if (!circle.is_along(start, end) || !circle.is_beneath(start) || !circle.is_beneath(end))
      continue;
    const double length = (to - from).norm();
    const double depth =
        std::abs(circle.depth(start) + 4 * circle.depth((start + end) / 2) + circle.depth(end)) / 6 / unit_;
    // The field before the panel reaches as far as the gap is wide, the charge on the wall about as far.
    const double reach = std::min(panel.area / length, panel.area / (4 * pi * largest_charge));
    result += 4 * pi * depth * length * reach / (panel.area * panel.area);
  }
  return result;
}

}  // namespace fringe::detail
