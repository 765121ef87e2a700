#pragma once

#include "fringe/triangle.hpp"
#include "numeric/quadrature_rules.hpp"

/// Computes ∫dA/d over a triangle by a sum over nodes, where d is a function of the point.
namespace fringe::detail {

/// Computes the integral by the thesis' own method (5.3.2, 5.3.3): divides the triangle into 4^levels
/// congruent ones and uses the distance of each one's centroid.
template <class Distance>
double split_integral(const Triangle& triangle, double twice_area, int levels, const Distance& distance) {
  // Splitting `levels` times gives 2^levels rows of small triangles parallel to an edge. Row i contains rows
  // − i triangles oriented like the whole one and rows − i − 1 rotated by 180 degrees.
  const int rows = 1 << levels;
  const Eigen::Vector3d step_u = (triangle[1] - triangle[0]) / rows;
  const Eigen::Vector3d step_v = (triangle[2] - triangle[0]) / rows;
  const auto inverse_distance = [&](double u, double v) {
    return 1 / distance(triangle[0] + u * step_u + v * step_v);
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

/// Computes the integral by the tensor product of two Gauss rules, collapsed onto the triangle's first vertex
/// (Duffy transformation).
template <class Distance>
double gauss_integral(const Triangle& triangle, double twice_area, const GaussRule& rule,
                      const Distance& distance) {
  const auto& [v0, v1, v2] = triangle;
  double sum = 0;
  for (const auto& [u, weight_u] : rule) {
    const Eigen::Vector3d start = v0 + u * (v1 - v0);
    const Eigen::Vector3d across = u * (v2 - v1);
    for (const auto& [v, weight_v] : rule)
      sum += weight_u * weight_v * u / distance(start + v * across);
  }
  return twice_area * sum;
}

}  // namespace fringe::detail
