#include "integral/nearest_nodes.hpp"

#include <algorithm>
#include <limits>

#include "numeric/gauss_rule.hpp"

namespace fringe::detail {
namespace {

using Eigen::Vector3d;

/// Computes 1/distance from a point to the plate nearest to it.
double inverse_distance_to_nearest(std::span<const PlateFrame> plates, const Vector3d& point) {
  double least = std::numeric_limits<double>::infinity();
  for (const PlateFrame& plate : plates)
    least = std::min(least, distance(plate, plate.axes * (point - plate.corner)));
  return 1 / least;
}

}  // namespace

double nearest_node_sum(const Triangle& triangle, std::span<const PlateFrame> plates, const Split& split) {
  const int rows = 1 << split.levels;
  const Vector3d step_u = (triangle[1] - triangle[0]) / rows, step_v = (triangle[2] - triangle[0]) / rows;
  double sum = 0;
  // Centroids of the small triangles oriented like the whole triangle, then of those rotated by 180 degrees.
  for (const double third : {1.0 / 3, 2.0 / 3})
    for (int i = 0; i < rows; ++i)
      for (int j = 0; i + j < (third < 0.5 ? rows : rows - 1); ++j)
        sum += inverse_distance_to_nearest(plates, triangle[0] + (i + third) * step_u + (j + third) * step_v);
  return twice_area(triangle) / 2 * sum / rows / rows;
}

double nearest_node_sum(const Triangle& triangle, std::span<const PlateFrame> plates, const Gauss& gauss) {
  const GaussRule rule = gauss_rule(gauss.points);
  double sum = 0;
  for (const auto& [u, weight_u] : rule)
    for (const auto& [v, weight_v] : rule) {
      const Vector3d node = triangle[0] + u * (triangle[1] - triangle[0] + v * (triangle[2] - triangle[1]));
      sum += weight_u * weight_v * u * inverse_distance_to_nearest(plates, node);
    }
  return twice_area(triangle) * sum;
}

}  // namespace fringe::detail
