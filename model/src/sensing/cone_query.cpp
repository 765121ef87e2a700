#include "sensing/cone_query.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>

namespace fringe::detail {
namespace {

using Eigen::Vector3d;

/// A triangle with a sine below this is treated as a segment: its normal would have too few digits, and its
/// width, at most this fraction of its length, changes no distance.
constexpr double thinnest = 0x1p-60;

/// Relative error of each coordinate within which an apex counts as lying on the triangle.
constexpr double apex_rounding = 0x1p-51;

double largest_component(const Vector3d& a) {
  return a.cwiseAbs().maxCoeff();
}

double largest_component(const PreciseVector& a) {
  return largest_component(rounded(a));
}

Vector3d times_power_of_two(const Vector3d& a, int exponent) {
  return a.unaryExpr([=](double x) { return std::ldexp(x, exponent); });
}

PreciseVector times_power_of_two(const PreciseVector& a, int exponent) {
  const auto scaled = [=](DoubleDouble x) {
    return DoubleDouble{std::ldexp(x.high, exponent), std::ldexp(x.low, exponent)};
  };
  return {scaled(a.x), scaled(a.y), scaled(a.z)};
}

/// A side of the triangle: the points of a line between two positions.
struct TriangleSide {
  bool has_length = false;
  PreciseVector direction;
  PreciseLine line;
  DoubleDouble from, to;
};

/// A triangle relative to the apex, scaled so that its largest coordinate is between 1 and 2.
struct SeenTriangle {
  std::array<PreciseVector, 3> vertices;
  std::array<TriangleSide, 3> sides;
  Vector3d rounding;  ///< error bound of each coordinate
};

/// Computes a side of the triangle; `difference` is end − start, computed without cancellation.
TriangleSide side_between(const PreciseVector& start, const PreciseVector& end,
                          const PreciseVector& difference) {
  const double size = largest_component(difference);
  if (size == 0)
    return {};
  const PreciseVector direction = polar(times_power_of_two(difference, -std::ilogb(size))).direction;
  const DoubleDouble from = dot(start, direction), to = dot(end, direction);
  const auto [distance, to_foot] = polar(start - from * direction);
  return {true, direction, {distance, to_foot, direction}, from, to};
}

/// Searches the candidates for the nearest point: the five cases of the thesis' section 4.2.
template <class Method>
class Search {
 public:
  Search(const SeenTriangle& triangle, const Method& cone) : triangle_(triangle), cone_(cone) {
    for (const PreciseVector& vertex : triangle.vertices)
      consider(vertex);
    for (const TriangleSide& side : triangle.sides)
      if (side.has_length)
        consider(side);
    consider_plane();
  }

  /// The nearest point of the triangle, whether in the cone or not.
  const PreciseVector& nearest() const { return nearest_; }
  const std::optional<PreciseVector>& visible() const { return visible_; }

 private:
  /// Handles case 5, the vertices, and any other point of the triangle.
  void consider(const PreciseVector& point) {
    const DoubleDouble square = dot(point, point);
    if (square < nearest_square_) {
      nearest_square_ = square;
      nearest_ = point;
    }
    if (square < visible_square_ && cone_.contains(point))
      see(point, square);
  }

  /// Records a point in the cone if it is the nearest so far.
  void see(const PreciseVector& point, DoubleDouble square) {
    if (square < visible_square_) {
      visible_square_ = square;
      visible_ = point;
    }
  }

  /// Handles cases 4 and 3: the foot of the perpendicular on a side, and the crossings of the side with the
  /// cone. A side whose line passes through the apex needs no crossings: unless the apex is on the side, the
  /// nearest of its points in the cone is an end.
  void consider(const TriangleSide& side) {
    if (side.from.high <= 0 && side.to.high >= 0)
      consider(side.line.point({}));
    if (side.line.distance.high <= precise_noise)
      return;
    for (const DoubleDouble position : cone_.crossings(side.line))
      if (position.high >= side.from.high - precise_noise && position.high <= side.to.high + precise_noise) {
        const PreciseVector point = side.line.point(position);
        see(point, dot(point, point));
      }
  }

  /// Handles cases 1 and 2: the foot of the perpendicular on the plane, and the crossings of the plane with
  /// the cone. The point of the cone's surface nearest to the foot lies in the direction of the axis'
  /// projection; the thesis' point S, where the axis meets the plane, need not exist.
  void consider_plane() {
    const PreciseVector product = cross(triangle_.sides[0].direction, triangle_.sides[1].direction);
    const auto [sine, normal] = polar(product);
    if (!(sine.high >= thinnest))
      return;
    for (std::size_t i = 0; i < 3; ++i)
      inward_[i] = cross(normal, triangle_.sides[i].direction);
    const DoubleDouble height = dot(normal, triangle_.vertices[0]);
    const PreciseVector foot = height * normal;
    if (in_triangle(foot))
      consider(foot);
    const auto [inclination, downhill] = polar(cone_.axis() - dot(cone_.axis(), normal) * normal);
    if (std::abs(height.high) <= precise_noise || inclination.high <= precise_noise)
      return;
    const bool ahead = height.high > 0;
    const PreciseLine line{ahead ? height : -height, ahead ? normal : -normal, downhill};
    for (const DoubleDouble position : cone_.crossings(line)) {
      const PreciseVector point = line.point(position);
      if (in_triangle(point))
        see(point, dot(point, point));
    }
  }

  /// Tests whether a point of the triangle's plane is in the triangle, up to rounding.
  bool in_triangle(const PreciseVector& point) const {
    for (std::size_t i = 0; i < 3; ++i)
      if (!(dot(inward_[i], point - triangle_.vertices[i]).high >= -precise_noise))
        return false;
    return true;
  }

  static constexpr DoubleDouble infinite{std::numeric_limits<double>::infinity(), 0};

  const SeenTriangle& triangle_;
  const Method& cone_;
  std::array<PreciseVector, 3> inward_;
  PreciseVector nearest_;
  DoubleDouble nearest_square_ = infinite;
  std::optional<PreciseVector> visible_;
  DoubleDouble visible_square_ = infinite;
};

/// A cone that contains nothing, in the frame in which the triangles are given. The nearest point of the
/// triangle does not depend on the cone.
struct NoCone {
  static const PreciseVector& to_frame(const PreciseVector& vector) { return vector; }
  static PreciseVector axis() { return {{}, {}, {1, 0}}; }
  static bool contains(const PreciseVector& /*point*/) { return false; }
  static Crossings crossings(const PreciseLine& /*line*/) { return {}; }
};

/// Returns the triangle in the cone's frame; scaling by the power of two brings its largest coordinate
/// between 1 and 2.
template <class Method>
SeenTriangle seen_from(const Vector3d& apex, const Triangle& triangle, int exponent, const Method& cone) {
  SeenTriangle seen;
  Vector3d largest = apex.cwiseAbs();
  for (std::size_t i = 0; i < 3; ++i) {
    seen.vertices[i] = cone.to_frame(times_power_of_two(exact_difference(triangle[i], apex), -exponent));
    largest = largest.cwiseMax(triangle[i].cwiseAbs() + apex.cwiseAbs());
  }
  seen.rounding = apex_rounding * times_power_of_two(largest, -exponent);
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t next = (i + 1) % 3;
    const PreciseVector difference =
        cone.to_frame(times_power_of_two(exact_difference(triangle[next], triangle[i]), -exponent));
    seen.sides[i] = side_between(seen.vertices[i], seen.vertices[next], difference);
  }
  return seen;
}

/// Tests whether moving each coordinate by its rounding error could bring the point to the origin.
bool is_origin_but_for_rounding(const Vector3d& point, const Vector3d& rounding) {
  return point.squaredNorm() <= point.cwiseAbs().dot(rounding);
}

/// Finds the nearest point for coordinates of ordinary magnitude.
template <class Method>
std::optional<NearestPoint> nearest_of_scaled(const Triangle& triangle, const Vector3d& apex,
                                              const Method& cone) {
  const NearestPoint here{0, apex};
  double size = 0;
  for (const Vector3d& vertex : triangle)
    size = std::max(size, largest_component(exact_difference(vertex, apex)));
  if (size == 0)
    return here;
  const int exponent = std::ilogb(size);
  const SeenTriangle seen = seen_from(apex, triangle, exponent, cone);
  const Search<Method> search(seen, cone);
  Vector3d nearest = rounded(cone.from_frame(search.nearest()));
  // Turning into the cone's frame leaves a rounding error in every coordinate, even in one that is exactly 0
  // in the frame of the triangle. A distance no larger than this error is computed again in the frame where
  // the coordinates are exact.
  if (largest_component(nearest) <= precise_noise) {
    const NoCone anywhere;
    const SeenTriangle exactly = seen_from(apex, triangle, exponent, anywhere);
    nearest = rounded(Search<NoCone>(exactly, anywhere).nearest());
  }
  if (is_origin_but_for_rounding(nearest, seen.rounding))
    return here;
  if (!search.visible())
    return std::nullopt;
  const PreciseVector offset = times_power_of_two(cone.from_frame(*search.visible()), exponent);
  const DoubleDouble distance = polar(*search.visible()).length;
  return NearestPoint{std::ldexp(distance.high, exponent),
                      rounded(exact_difference(apex, Vector3d::Zero()) + offset)};
}

}  // namespace

template <class Method>
std::optional<NearestPoint> nearest_on_triangle(const Triangle& triangle, const Vector3d& apex,
                                                const Method& cone) {
  // Between these exponents, differences and their low parts neither overflow nor underflow.
  constexpr int largest_exponent = 500, smallest_exponent = -400;
  double largest = largest_component(apex);
  for (const Vector3d& vertex : triangle)
    largest = std::max(largest, largest_component(vertex));
  const int exponent = largest > 0 ? std::ilogb(largest) : 0;
  if (exponent <= largest_exponent && exponent >= smallest_exponent)
    return nearest_of_scaled(triangle, apex, cone);
  Triangle scaled;
  for (std::size_t i = 0; i < 3; ++i)
    scaled[i] = times_power_of_two(triangle[i], -exponent);
  std::optional<NearestPoint> result = nearest_of_scaled(scaled, times_power_of_two(apex, -exponent), cone);
  if (result)
    *result = {std::ldexp(result->distance, exponent), times_power_of_two(result->point, exponent)};
  return result;
}

template std::optional<NearestPoint> nearest_on_triangle(const Triangle&, const Vector3d&,
                                                         const FieldOfView&);
template std::optional<NearestPoint> nearest_on_triangle(const Triangle&, const Vector3d&,
                                                         const ConeEquation&);

namespace {

using AnyMethod = std::variant<FieldOfView, ConeEquation>;

AnyMethod prepared(const SensingCone& cone, ConeMethod method) {
  validate(cone);
  const PreciseCone precise = precise_cone(cone.direction, cone.full_angle);
  if (method == ConeMethod::field_of_view)
    return FieldOfView(precise);
  return ConeEquation(precise);
}

}  // namespace

ConeQuery::ConeQuery(const SensingCone& cone, ConeMethod method)
    : cone_(cone), method_(prepared(cone, method)), reach_(cone.range * (1 + boundary_width)) {}

void ConeQuery::offer(const Triangle& triangle, std::size_t surface, std::size_t index) {
  const std::optional<NearestPoint> nearest = std::visit(
      [&](const auto& method) { return nearest_on_triangle(triangle, cone_.apex, method); }, method_);
  if (!nearest || !improves(nearest->distance, surface, index))
    return;
  best_ = {{nearest->distance, nearest->point, index}, surface};
  reach_ = nearest->distance;
}

bool ConeQuery::improves(double distance, std::size_t surface, std::size_t index) const {
  if (!best_)
    return distance <= reach_;
  return std::tie(distance, surface, index) <
         std::tie(best_->point.distance, best_->surface, best_->point.triangle);
}

}  // namespace fringe::detail
