#include "bem/round_shape.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

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

/// Returns how far a point of the polygon's outline is within the disc's.
double depth_of_rim(const Disc& disc, const Vector3d& point) {
  return disc.radius - from_axis(point);
}

/// Tells if a point lies on the rim of a disc or on the outline of the polygon that stands for it.
bool is_on_rim(const Disc& disc, const Vector3d& point) {
  constexpr double rounding = 1e-9;
  const double step = 2 * std::numbers::pi / disc.segments;
  const double angle = std::remainder(std::atan2(point.y(), point.x()) - step / 2, step);
  return depth_of_rim(disc, point) < rounding * disc.radius ||
         std::abs(from_axis(point) * std::cos(angle) - disc.radius * std::cos(step / 2)) <
             rounding * disc.radius;
}

/// Returns how far a point of the polyhedron has to move to lie on a shape's surface, in the shape's frame.
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
  Vector3d operator()(const Disc& disc) const {
    if (!is_on_rim(disc, point))
      return Vector3d::Zero();
    return Vector3d(point.x(), point.y(), 0) * (disc.radius / from_axis(point) - 1);
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

}  // namespace

std::optional<RoundShape> RoundShape::of(const Shape& shape, const Eigen::Isometry3d& pose) {
  if (std::holds_alternative<Plate>(shape) || std::holds_alternative<Cuboid>(shape) ||
      std::holds_alternative<Mesh>(shape) || std::holds_alternative<Polygon>(shape))
    return std::nullopt;
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

bool RoundShape::is_followed() const {
  return !std::holds_alternative<Cylinder>(shape_) && !std::holds_alternative<Cone>(shape_) &&
         !std::holds_alternative<Arc>(shape_);
}

Vector3d RoundShape::on_shape(const Vector3d& point) const {
  /// Displacement over the distance from the shape's centre up to which a point is on the shape already.
  constexpr double rounding = 1e-12;
  const Vector3d place = to_shape_ * point, way = std::visit(Displacement{place}, shape_);
  return way.norm() > rounding * place.norm() ? Vector3d(point + to_shape_.linear().inverse() * way) : point;
}

Vector3d RoundShape::middle(const Vector3d& from, const Vector3d& to) const {
  Vector3d middle = (from + to) / 2;
  if (const auto* const disc = std::get_if<Disc>(&shape_)) {
    if (!is_on_rim(*disc, to_shape_ * from) || !is_on_rim(*disc, to_shape_ * to))
      return middle;
    // Beyond the polygon's sides the middle of a side along the rim is on no outline.
    const Vector3d place = to_shape_ * middle;
    return middle + to_shape_.linear().inverse() *
                        (Vector3d(place.x(), place.y(), 0) * (disc->radius / from_axis(place) - 1));
  }
  return on_shape(middle);
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

double RoundShape::depth(const Triangle& part) const {
  double sum = 0;
  // The depth of a facet is of the second degree, but for cones: the middles of the sides have its mean.
  for (const auto& [from, over, to] : quarters(part)) {
    const Vector3d a = to_shape_ * from, b = to_shape_ * over, c = to_shape_ * to;
    const Vector3d centre = (a + b + c) / 3, normal = (b - a).cross(c - a).normalized();
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
  for (std::size_t side = 0; side < 3; ++side) {
    const Vector3d from = to_shape_ * panel.corners[side], to = to_shape_ * panel.corners[(side + 1) % 3];
    const Vector3d middle = (from + to) / 2;
    if (is_on_rim(*disc, from) && is_on_rim(*disc, to))
      sum += (depth_of_rim(*disc, from) + 4 * depth_of_rim(*disc, middle) + depth_of_rim(*disc, to)) / 6;
  }
  return 9 * pi * pi / 16 * sum / unit_ / panel.area;
}

}  // namespace fringe::detail
