#include "row_sum.hpp"

namespace fringe::stress {
namespace {

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

}  // namespace

DoubleDouble row_sum(const DoubleDoubleVector& apex, const DoubleDoubleVector& ray, const PlateExtent& extent,
                     const Rule& rule) {
  DoubleDouble sum;
  for (std::size_t i = 0; i < rule.size(); ++i) {
    const DoubleDouble s = rule.position(i);
    sum = sum + rule.weight(i) * s * inverse_distance(apex + s * ray, extent);
  }
  return sum;
}

}  // namespace fringe::stress
