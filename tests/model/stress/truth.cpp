#include "truth.hpp"

#include <array>
#include <cmath>
#include <limits>

namespace fringe::stress {
namespace {

struct DoubleDoubleVector {
  DoubleDouble x, y, z;
};

DoubleDoubleVector operator+(const DoubleDoubleVector& a, const DoubleDoubleVector& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}

DoubleDoubleVector operator*(DoubleDouble factor, const DoubleDoubleVector& vector) {
  return {factor * vector.x, factor * vector.y, factor * vector.z};
}

/// Side lengths of the plate 0 ≤ x ≤ u, 0 ≤ y ≤ v, z = 0.
struct PlateExtent {
  DoubleDouble u, v;
};

/// Computes x − clamp(x, 0, length).
inline DoubleDouble beyond(DoubleDouble x, DoubleDouble length) {
  const DoubleDouble above = x - length;
  if (above.high > 0)
    return above;
  return x.high < 0 ? x : DoubleDouble{};
}

inline DoubleDouble inverse_distance(const DoubleDoubleVector& point, const PlateExtent& extent) {
  const DoubleDouble u = beyond(point.x, extent.u), v = beyond(point.y, extent.v);
  return inverse_square_root(u * u + v * v + point.z * point.z);
}

/// Computes ∫₀¹ s ds/d(apex + s·ray) by a quadrature rule, where d is the distance to the plate.
DoubleDouble row_sum(const DoubleDoubleVector& apex, const DoubleDoubleVector& ray, const PlateExtent& extent,
                     const Rule& rule) {
  DoubleDouble sum;
  for (std::size_t i = 0; i < rule.size(); ++i) {
    const DoubleDouble s = rule.position(i);
    sum = sum + rule.weight(i) * s * inverse_distance(apex + s * ray, extent);
  }
  return sum;
}

DoubleDoubleVector to_double_double(const RealVector& vector) {
  return {stress::to_double_double(vector.x()), stress::to_double_double(vector.y()),
          stress::to_double_double(vector.z())};
}

double norm(const RealVector& vector) {
  return static_cast<double>(Real(sqrt(vector.squaredNorm())));
}

/// Computes the ratio of distance to length; infinite where the segment has no length.
double closeness(double distance, double length) {
  return length > 0 ? distance / length : std::numeric_limits<double>::infinity();
}

DoubleDouble integrate(const Sector& sector, const PlateExtent& extent, const GradedRules& rules) {
  const RealVector along = sector.end.position - sector.start.position;
  const DoubleDoubleVector apex = to_double_double(sector.apex.position),
                           start = to_double_double(sector.start.position - sector.apex.position),
                           step = to_double_double(along);
  const double apex_distance = norm(sector.apex.from_plate);
  const Eigen::Vector3d start_from_plate =
      RealVector(sector.start.from_plate - sector.apex.from_plate).cast<double>();
  const RealVector along_from_plate = sector.end.from_plate - sector.start.from_plate;
  const Eigen::Vector3d step_from_plate = along_from_plate.cast<double>();

  const Rule& across = rules.rule(closeness(norm(sector.start.from_plate), norm(along_from_plate)));
  DoubleDouble sum;
  for (std::size_t i = 0; i < across.size(); ++i) {
    const DoubleDouble t = across.position(i);
    const DoubleDoubleVector ray = start + t * step;
    const double ray_length = (start_from_plate + t.high * step_from_plate).norm();
    sum =
        sum + across.weight(i) * row_sum(apex, ray, extent, rules.rule(closeness(apex_distance, ray_length)));
  }
  const Real area = twice_area(sector.apex.position, sector.start.position, sector.end.position);
  return stress::to_double_double(area) * sum;
}

DoubleDouble integrate(const Dissection& dissection, const GradedRules& rules) {
  const PlateExtent extent{stress::to_double_double(dissection.frame.lengths[0]),
                           stress::to_double_double(dissection.frame.lengths[1])};
  DoubleDouble sum;
  for (const Sector& sector : dissection.sectors)
    sum = sum + integrate(sector, extent, rules);
  return sum;
}

}  // namespace

Truth integrate(const Dissection& dissection) {
  if (dissection.twice_area == 0)
    return {{0, 0}, true};
  if (dissection.divergent)
    return {{std::numeric_limits<double>::infinity(), 0}, true};
  // The number of points is estimated for the singularities along s; along t they may be closer. Then the
  // results of the first two orders disagree, and a later order with more points is used.
  static const std::array<GradedRules, 4> rules{GradedRules(18), GradedRules(23), GradedRules(34),
                                                GradedRules(50)};
  constexpr double agreement = 1e-19;
  Truth truth{integrate(dissection, rules.front()), false};
  for (std::size_t i = 1; i < rules.size() && !truth.converged; ++i) {
    const DoubleDouble value = integrate(dissection, rules[i]);
    truth.converged = std::abs((value - truth.value).high) <= agreement * value.high;
    truth.value = value;
  }
  return truth;
}

}  // namespace fringe::stress
