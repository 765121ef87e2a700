#include "panel.hpp"

#include <algorithm>
#include <cmath>

namespace fringe::detail {

using Eigen::Vector3d;

Panel make_panel(const Triangle& corners) {
  const Vector3d centre = (corners[0] + corners[1] + corners[2]) / 3;
  double squared_radius = 0;
  for (const Vector3d& corner : corners)
    squared_radius = std::max(squared_radius, (corner - centre).squaredNorm());
  return {corners, centre, std::sqrt(squared_radius), twice_area(corners) / 2};
}

std::array<Triangle, 4> quarters(const Triangle& triangle) {
  const auto& [a, b, c] = triangle;
  const Vector3d ab = (a + b) / 2, bc = (b + c) / 2, ca = (c + a) / 2;
  return {Triangle{a, ab, ca}, Triangle{ab, b, bc}, Triangle{ca, bc, c}, Triangle{ab, bc, ca}};
}

std::array<Triangle, 2> halves(const Triangle& triangle, std::size_t side) {
  const Vector3d &from = triangle[side], &to = triangle[(side + 1) % 3], &opposite = triangle[(side + 2) % 3];
  const Vector3d middle = (from + to) / 2;
  return {Triangle{from, middle, opposite}, Triangle{middle, to, opposite}};
}

std::size_t longest_side(const Triangle& triangle) {
  /// Sides that rounding makes longer than others are not.
  constexpr double longer = 1 + 1e-6;
  std::size_t longest = 0;
  double length = 0;
  for (std::size_t side = 0; side < 3; ++side) {
    const double here = (triangle[(side + 1) % 3] - triangle[side]).norm();
    if (here > longer * length) {
      longest = side;
      length = here;
    }
  }
  return longest;
}

double segment_distance(const Vector3d& point, const Vector3d& from, const Vector3d& to) {
  const Vector3d along = to - from, offset = point - from;
  const double part = std::clamp(offset.dot(along) / along.squaredNorm(), 0.0, 1.0);
  return (offset - part * along).norm();
}

double outline_distance(const Triangle& triangle, const Vector3d& point) {
  return std::min({segment_distance(point, triangle[0], triangle[1]),
                   segment_distance(point, triangle[1], triangle[2]),
                   segment_distance(point, triangle[2], triangle[0])});
}

}  // namespace fringe::detail
