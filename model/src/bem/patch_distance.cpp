#include "bem/patch_distance.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Geometry>

namespace fringe::detail {

NearestParts nearest_parts(const Eigen::Vector3d& a0, const Eigen::Vector3d& a1, const Eigen::Vector3d& b0,
                           const Eigen::Vector3d& b1) {
  const Eigen::Vector3d a = a1 - a0, b = b1 - b0, between = a0 - b0;
  const double aa = a.squaredNorm(), bb = b.squaredNorm(), ab = a.dot(b);
  const double along_a = a.dot(between), along_b = b.dot(between);
  const double determinant = aa * bb - ab * ab;
  double s = 0, t = 0;
  if (aa > 0 && determinant > 0)
    s = std::clamp((ab * along_b - along_a * bb) / determinant, 0.0, 1.0);
  if (bb > 0)
    t = (ab * s + along_b) / bb;
  if (t < 0 || t > 1) {
    t = std::clamp(t, 0.0, 1.0);
    s = aa > 0 ? std::clamp((ab * t - along_a) / aa, 0.0, 1.0) : 0;
  }
  return {s, t};
}

double segment_distance(const Eigen::Vector3d& a0, const Eigen::Vector3d& a1, const Eigen::Vector3d& b0,
                        const Eigen::Vector3d& b1) {
  const auto [s, t] = nearest_parts(a0, a1, b0, b1);
  return (a0 + s * (a1 - a0) - b0 - t * (b1 - b0)).norm();
}

double edge_distance(const Eigen::Vector2d& low, const Eigen::Vector2d& high, Eigen::Index axis,
                     const RectangleCorners& other) {
  /// Sine of the angle to the axis below which an edge counts as parallel: its singularity is out of sight.
  constexpr double parallel = 1e-9;
  const RectangleCorners own{Eigen::Vector3d(low.x(), low.y(), 0), Eigen::Vector3d(high.x(), low.y(), 0),
                             Eigen::Vector3d(high.x(), high.y(), 0), Eigen::Vector3d(low.x(), high.y(), 0)};
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < 4; ++k) {
    const Eigen::Vector2d nearest = other[k].head<2>().cwiseMax(low).cwiseMin(high);
    least = std::min(least, std::hypot((other[k].head<2>() - nearest).norm(), other[k].z()));
    const Eigen::Vector3d edge = other[(k + 1) % 4] - other[k];
    if (edge.cross(Eigen::Vector3d::Unit(axis)).norm() <= parallel * edge.norm())
      continue;
    for (std::size_t i = 0; i < 4; ++i)
      least = std::min(least, segment_distance(own[i], own[(i + 1) % 4], other[k], other[(k + 1) % 4]));
  }
  return least;
}

}  // namespace fringe::detail
