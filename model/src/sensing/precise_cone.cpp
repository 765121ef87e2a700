#include "sensing/precise_cone.hpp"

#include <cmath>

namespace fringe::detail {
namespace {

struct CosineAndSine {
  DoubleDouble cosine, sine;
};

/// Computes both by the Taylor series at an eighth of the angle, whose terms fall below 2^−110 after the
/// twelfth, and by doubling the angle three times. The doubling works on 1 − cosine, so that a cosine near 1
/// keeps its digits.
CosineAndSine cosine_and_sine(DoubleDouble angle) {
  constexpr int halvings = 3, terms = 24;
  const DoubleDouble x = 0x1p-3 * angle, square = x * x;
  DoubleDouble versine{}, sine = x;
  DoubleDouble even = 0.5 * square, odd = x;
  for (int n = 2; n <= terms; n += 2) {
    versine = versine + even;
    odd = -(odd * square) / DoubleDouble{static_cast<double>(n * (n + 1)), 0};
    sine = sine + odd;
    even = -(even * square) / DoubleDouble{static_cast<double>((n + 1) * (n + 2)), 0};
  }
  constexpr DoubleDouble one{1, 0};
  for (int i = 0; i < halvings; ++i) {
    sine = 2.0 * (sine * (one - versine));
    versine = 2.0 * (versine * (DoubleDouble{2, 0} - versine));
  }
  return {one - versine, sine};
}

}  // namespace

PreciseCone precise_cone(const Eigen::Vector3d& direction, double full_angle) {
  const int exponent = std::ilogb(direction.cwiseAbs().maxCoeff());
  const Eigen::Vector3d scaled = direction.unaryExpr([=](double x) { return std::ldexp(x, -exponent); });
  const auto [cosine, sine] = cosine_and_sine(exact_sum(full_angle / 2, boundary_width));
  return {polar(exact_difference(scaled, Eigen::Vector3d::Zero())).direction, cosine, sine};
}

bool FieldOfView::contains(const PreciseVector& point) const {
  const DoubleDouble ahead = dot(cone_.axis, point), square = dot(point, point);
  // In a narrow cone cosines hardly differ but sines do; in a wide cone it is the other way round.
  if (cone_.cosine.high < cone_.sine.high)
    return (ahead - (cone_.cosine - DoubleDouble{precise_noise, 0}) * square_root(square)).high >= 0;
  const PreciseVector aside = cross(cone_.axis, point);
  return ahead.high >= 0 &&
         (dot(aside, aside) - (1 + precise_noise) * (cone_.sine * cone_.sine * square)).high <= 0;
}

Crossings FieldOfView::crossings(const PreciseLine& line) const {
  // The plane through the line and the apex contains two rays of the cone's surface, at equal angles to the
  // axis' projection, whose components are `towards` and `along`; the tangents of these angles are `width`
  // over the cosine. This finds crossings with the cone only and never with its mirror image, which also
  // solves the squared equation.
  const DoubleDouble towards = dot(cone_.axis, line.to_foot), along = dot(cone_.axis, line.along);
  DoubleDouble square, largest;
  if (cone_.cosine.high < cone_.sine.high) {
    const DoubleDouble projection = towards * towards + along * along, limit = cone_.cosine * cone_.cosine;
    square = projection - limit;
    largest = projection + limit;
  } else {
    const DoubleDouble out_of_plane = dot(cone_.axis, cross(line.to_foot, line.along));
    const DoubleDouble height = out_of_plane * out_of_plane, limit = cone_.sine * cone_.sine;
    square = limit - height;
    largest = limit + height;
  }
  if (square.high < -precise_noise * largest.high)
    return {};
  const DoubleDouble width = square.high > 0 ? square_root(square) : DoubleDouble{};
  Crossings result;
  for (const DoubleDouble side : {width, -width}) {
    const DoubleDouble cosine = towards * cone_.cosine - along * side,
                       sine = along * cone_.cosine + towards * side;
    if (cosine.high > 0)
      result.add(line.distance * sine / cosine);
  }
  return result;
}

namespace {

/// Returns the unit vector along the coordinate axis that makes the largest angle with a direction.
PreciseVector farthest_coordinate_axis(const PreciseVector& direction) {
  Eigen::Index index = 0;
  rounded(direction).cwiseAbs().minCoeff(&index);
  return exact_difference(Eigen::Vector3d::Unit(index), Eigen::Vector3d::Zero());
}

}  // namespace

ConeEquation::ConeEquation(const PreciseCone& cone)
    : x_(polar(cross(cone.axis, farthest_coordinate_axis(cone.axis))).direction), y_(cross(cone.axis, x_)),
      z_(cone.axis), cosine_squared_(cone.cosine * cone.cosine), sine_squared_(cone.sine * cone.sine),
      cosine_sign_(cone.cosine.high < 0 ? -1 : 1) {}

bool ConeEquation::contains(const PreciseVector& point) const {
  const DoubleDouble across = cosine_squared_ * (point.x * point.x + point.y * point.y),
                     ahead = sine_squared_ * (point.z * point.z);
  if (cosine_sign_ > 0)
    return point.z.high >= 0 && (across - (1 + precise_noise) * ahead).high <= 0;
  return point.z.high >= 0 || (ahead - (1 + precise_noise) * across).high <= 0;
}

bool ConeEquation::on_mirror_cone(const PreciseLine& line, DoubleDouble position_over_distance) const {
  const DoubleDouble z = line.to_foot.z + position_over_distance * line.along.z;
  return cosine_sign_ * z.high < -precise_noise * (1 + std::abs(position_over_distance.high));
}

Crossings ConeEquation::crossings(const PreciseLine& line) const {
  const PreciseVector &f = line.to_foot, &e = line.along;
  // a·t² + 2b·t + c = 0, where t is the position divided by the distance.
  const DoubleDouble a = cosine_squared_ * (e.x * e.x + e.y * e.y) - sine_squared_ * (e.z * e.z),
                     b = cosine_squared_ * (f.x * e.x + f.y * e.y) - sine_squared_ * (f.z * e.z),
                     c = cosine_squared_ * (f.x * f.x + f.y * f.y) - sine_squared_ * (f.z * f.z);
  // b² − a·c, rewritten to avoid its cancellation: cos²·(sin²·(m_x² + m_y²) − cos²·m_z²), m = f × e.
  const PreciseVector m = cross(f, e);
  const DoubleDouble steepness = sine_squared_ * (m.x * m.x + m.y * m.y),
                     limit = cosine_squared_ * (m.z * m.z);
  const DoubleDouble discriminant = steepness - limit;
  if (discriminant.high < -precise_noise * (steepness.high + limit.high))
    return {};
  const DoubleDouble root =
      discriminant.high > 0 ? square_root(cosine_squared_ * discriminant) : DoubleDouble{};
  const DoubleDouble sum = b.high < 0 ? root - b : -(b + root);
  Crossings result;
  const auto add = [&](DoubleDouble t) {
    if (std::isfinite(t.high) && !on_mirror_cone(line, t))
      result.add(line.distance * t);
  };
  if (sum.high == 0) {
    if (a.high != 0)
      add(DoubleDouble{});
    return result;
  }
  add(c / sum);
  if (a.high != 0)
    add(sum / a);
  return result;
}

}  // namespace fringe::detail
