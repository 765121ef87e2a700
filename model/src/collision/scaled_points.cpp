#include "collision/scaled_points.hpp"

#include <algorithm>
#include <cmath>

#include "fringe/bounding_volume.hpp"

namespace fringe::detail {

ScaledPoints scaled_points(std::span<const Eigen::Vector3d> points) {
  const Eigen::AlignedBox3d box = axis_aligned_box(points);
  const double largest = std::max(box.min().cwiseAbs().maxCoeff(), box.max().cwiseAbs().maxCoeff());
  const int exponent = largest == 0 ? 0 : std::ilogb(largest) + 1;
  const auto scaled = [=](const Eigen::Vector3d& point) -> Eigen::Vector3d {
    return point.unaryExpr([=](double x) { return std::ldexp(x, -exponent); });
  };
  ScaledPoints result{{}, (scaled(box.min()) + scaled(box.max())) / 2, exponent};
  result.points.reserve(points.size());
  for (const Eigen::Vector3d& point : points)
    result.points.push_back(scaled(point));
  return result;
}

}  // namespace fringe::detail
