#include "surface/panel.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <Eigen/Geometry>

namespace fringe::detail {

using Eigen::Vector3d;

namespace {

/// Returns the square of a point's distance from a segment, whose ends may be the same point.
double squared_distance(const Vector3d& point, const Vector3d& from, const Vector3d& to) {
  const Vector3d along = to - from, offset = point - from;
  const double squared = along.squaredNorm();
  const double part = squared > 0 ? std::clamp(offset.dot(along) / squared, 0.0, 1.0) : 0;
  return (offset - part * along).squaredNorm();
}

}  // namespace

Panel make_panel(const Triangle& corners) {
  const Vector3d centre = centre_of(corners);
  double squared_radius = 0;
  for (const Vector3d& corner : corners)
    squared_radius = std::max(squared_radius, (corner - centre).squaredNorm());
  return {corners, centre, std::sqrt(squared_radius), twice_area(corners) / 2};
}

Vector3d centre_of(const Triangle& triangle) {
  return (triangle[0] + triangle[1] + triangle[2]) / 3;
}

Vector3d unit_normal(const Triangle& triangle) {
  return (triangle[1] - triangle[0]).cross(triangle[2] - triangle[0]).normalized();
}

std::array<Vector3d, 3> middles_of_sides(const Triangle& triangle) {
  const auto& [a, b, c] = triangle;
  return {(a + b) / 2, (b + c) / 2, (c + a) / 2};
}

std::array<Triangle, 4> quarters(const Triangle& triangle, const std::array<Vector3d, 3>& middles) {
  const auto& [a, b, c] = triangle;
  const auto& [ab, bc, ca] = middles;
  return {Triangle{a, ab, ca}, Triangle{ab, b, bc}, Triangle{ca, bc, c}, Triangle{ab, bc, ca}};
}

std::array<Triangle, 4> quarters(const Triangle& triangle) {
  return quarters(triangle, middles_of_sides(triangle));
}

void add_centres_of_parts(const Triangle& triangle, int quarterings, std::vector<Vector3d>& centres) {
  if (quarterings == 0) {
    centres.push_back(centre_of(triangle));
    return;
  }
  for (const Triangle& quarter : quarters(triangle))
    add_centres_of_parts(quarter, quarterings - 1, centres);
}

std::array<Triangle, 2> halves(const Triangle& triangle, std::size_t side, const Vector3d& middle) {
  const Vector3d &from = triangle[side], &to = triangle[(side + 1) % 3], &opposite = triangle[(side + 2) % 3];
  return {Triangle{from, middle, opposite}, Triangle{middle, to, opposite}};
}

std::array<Triangle, 2> halves(const Triangle& triangle, std::size_t side) {
  return halves(triangle, side, (triangle[side] + triangle[(side + 1) % 3]) / 2);
}

std::size_t longest_side(const Triangle& triangle) {
  /// Ratio of lengths above which a side is longer than another; smaller differences are rounding.
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

std::size_t side_to_halve(const Triangle& triangle, const Eigen::MatrixXd& quarter_charges,
                          const std::array<double, 3>& bends) {
  /// Ratio of longest side to height above which a triangle is halved across its longest side.
  constexpr double slimmest = 60;
  const double longest =
      (triangle[(longest_side(triangle) + 1) % 3] - triangle[longest_side(triangle)]).norm();
  // The energy of a difference of charges is about twice its square over the triangle's size.
  const double squared_charge = quarter_charges.colwise().sum().squaredNorm();
  const double per_energy = std::sqrt(twice_area(triangle) / 2) / 2;
  std::array<double, 3> changes{};
  for (std::size_t side = 0; side < 3; ++side) {
    const auto from = static_cast<Eigen::Index>(side), to = static_cast<Eigen::Index>((side + 1) % 3);
    changes[side] = std::sqrt((quarter_charges.row(from) - quarter_charges.row(to)).squaredNorm() +
                              per_energy * bends[side] * squared_charge);
  }
  const double largest = *std::max_element(changes.begin(), changes.end());
  /// Fraction of the largest change. Of the sides with a larger change the longest is taken.
  constexpr double about = 0.8;
  std::size_t chosen = longest_side(triangle);
  double length = changes[chosen] >= about * largest ? longest : 0;
  for (std::size_t side = 0; side < 3; ++side) {
    const double here = (triangle[(side + 1) % 3] - triangle[side]).norm();
    if (changes[side] >= about * largest && here > (1 + 1e-6) * length) {
      chosen = side;
      length = here;
    }
  }
  const double height = twice_area(triangle) / longest;
  return longest > slimmest * height ? longest_side(triangle) : chosen;
}

double segment_distance(const Vector3d& point, const Vector3d& from, const Vector3d& to) {
  return std::sqrt(squared_distance(point, from, to));
}

double outline_distance(const Triangle& triangle, const Vector3d& point) {
  return std::sqrt(std::min({squared_distance(point, triangle[0], triangle[1]),
                             squared_distance(point, triangle[1], triangle[2]),
                             squared_distance(point, triangle[2], triangle[0])}));
}

double triangle_distance(const Triangle& triangle, const Vector3d& point) {
  const auto& [a, b, c] = triangle;
  const Vector3d normal = (b - a).cross(c - a).stableNormalized();
  const auto is_inside = [&](const Vector3d& from, const Vector3d& to) {
    return (to - from).cross(point - from).dot(normal) >= 0;
  };
  if (normal.norm() > 0.5 && is_inside(a, b) && is_inside(b, c) && is_inside(c, a))
    return std::abs((point - a).dot(normal));
  return outline_distance(triangle, point);
}

}  // namespace fringe::detail
