#include <cmath>

#include "sensing/cone_line.hpp"

namespace fringe::detail {
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
