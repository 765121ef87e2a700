#include "integral/gauss.hpp"

namespace fringe::detail {

double gauss_integral(const PlateFrame& plate, const LocalTriangle& triangle, double twice_area,
                      const GaussRule& rule) {
  const auto& [v0, v1, v2] = triangle;
  double sum = 0;
  for (const auto& [u, weight_u] : rule) {
    const Eigen::Vector3d start = v0 + u * (v1 - v0);
    const Eigen::Vector3d across = u * (v2 - v1);
    for (const auto& [v, weight_v] : rule)
      sum += weight_u * weight_v * u / distance(plate, start + v * across);
  }
  return twice_area * sum;
}

}  // namespace fringe::detail
