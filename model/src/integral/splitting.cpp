#include "integral/splitting.hpp"

namespace fringe::detail {

double split_integral(const PlateFrame& plate, const LocalTriangle& triangle, double twice_area, int levels) {
  // Splitting `levels` times gives 2^levels rows of small triangles parallel to an edge. Row i contains rows
  // − i triangles oriented like the whole one and rows − i − 1 rotated by 180 degrees.
  const int rows = 1 << levels;
  const Eigen::Vector3d step_u = (triangle[1] - triangle[0]) / rows;
  const Eigen::Vector3d step_v = (triangle[2] - triangle[0]) / rows;
  const auto inverse_distance = [&](double u, double v) {
    return 1 / distance(plate, triangle[0] + u * step_u + v * step_v);
  };
  double sum = 0;
  for (int i = 0; i < rows; ++i) {
    for (int j = 0; j < rows - i; ++j)
      sum += inverse_distance(i + 1.0 / 3, j + 1.0 / 3);
    for (int j = 0; j < rows - i - 1; ++j)
      sum += inverse_distance(i + 2.0 / 3, j + 2.0 / 3);
  }
  return twice_area / 2 * sum / rows / rows;
}

}  // namespace fringe::detail
