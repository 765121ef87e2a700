#include "nearest_triangle.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace sizes {

namespace {

constexpr std::size_t most_in_leaf = 4;

Vector minus(const Vector& a, const Vector& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}

Vector along(const Vector& a, double share, const Vector& side) {
  return {a[0] + share * side[0], a[1] + share * side[1], a[2] + share * side[2]};
}

double dot(const Vector& a, const Vector& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

double square(const Vector& a) {
  return dot(a, a);
}

/// Returns the square of the distance from a segment.
double from_segment(const Vector& point, const Vector& a, const Vector& b) {
  const Vector side = minus(b, a), to = minus(point, a);
  const double length = square(side);
  const double share = length > 0 ? std::clamp(dot(to, side) / length, 0.0, 1.0) : 0.0;
  return square(minus(point, along(a, share, side)));
}

/// Returns the square of the distance from a triangle: that from its plane, if the point is above it, else
/// that from its nearest side.
double from_triangle(const Vector& point, const Triangle& triangle) {
  const auto& [a, b, c] = triangle;
  const Vector ab = minus(b, a), ac = minus(c, a), to = minus(point, a);
  const double bb = square(ab), cc = square(ac), bc = dot(ab, ac);
  const double determinant = bb * cc - bc * bc;
  if (determinant > 0) {
    const double u = (cc * dot(to, ab) - bc * dot(to, ac)) / determinant;
    const double v = (bb * dot(to, ac) - bc * dot(to, ab)) / determinant;
    if (u >= 0 && v >= 0 && u + v <= 1)
      return square(minus(to, along(along({0, 0, 0}, u, ab), v, ac)));
  }
  return std::min({from_segment(point, a, b), from_segment(point, b, c), from_segment(point, c, a)});
}

double middle(const Triangle& triangle, std::size_t axis) {
  return triangle[0][axis] + triangle[1][axis] + triangle[2][axis];
}

}  // namespace

NearestTriangle::NearestTriangle(std::span<const Triangle> given, std::span<const double> offsets) {
  for (std::size_t k = 0; k < given.size(); ++k)
    triangles.push_back({given[k], offsets[k]});
  build(0, triangles.size());
}

std::size_t NearestTriangle::build(std::size_t first, std::size_t last) {
  Box box{triangles[first].triangle[0], triangles[first].triangle[0]};
  double least_offset = triangles[first].offset;
  for (std::size_t k = first; k < last; ++k) {
    least_offset = std::min(least_offset, triangles[k].offset);
    for (const Vector& corner : triangles[k].triangle)
      for (std::size_t axis = 0; axis < 3; ++axis) {
        box.low[axis] = std::min(box.low[axis], corner[axis]);
        box.high[axis] = std::max(box.high[axis], corner[axis]);
      }
  }
  const std::size_t node = nodes.size();
  nodes.push_back({box, least_offset, first, last, 0});
  if (last - first <= most_in_leaf)
    return node;
  const Vector extent = minus(box.high, box.low);
  const auto axis = static_cast<std::size_t>(std::ranges::max_element(extent) - extent.begin());
  const std::size_t half = first + (last - first) / 2;
  const auto at = [this](std::size_t k) { return triangles.begin() + static_cast<std::ptrdiff_t>(k); };
  std::nth_element(at(first), at(half), at(last), [axis](const Placed& one, const Placed& other) {
    return std::pair(middle(one.triangle, axis), one) < std::pair(middle(other.triangle, axis), other);
  });
  build(first, half);
  nodes[node].second_child = build(half, last);
  return node;
}

double NearestTriangle::distance(const Vector& point) const {
  double nearest = std::numeric_limits<double>::infinity();
  search(0, point, nearest);
  return nearest;
}

void NearestTriangle::search(std::size_t node, const Vector& point, double& nearest) const {
  const auto& [box, least_offset, first, last, second_child] = nodes[node];
  if (second_child == 0) {
    for (std::size_t k = first; k < last; ++k)
      nearest =
          std::min(nearest, std::sqrt(from_triangle(point, triangles[k].triangle)) + triangles[k].offset);
    return;
  }
  const auto least = [&](std::size_t child) {
    const Box& of_child = nodes[child].box;
    double sum = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double beyond =
          std::max({of_child.low[axis] - point[axis], point[axis] - of_child.high[axis], 0.0});
      sum += beyond * beyond;
    }
    return std::sqrt(sum) + nodes[child].least_offset;
  };
  std::array<std::pair<double, std::size_t>, 2> children{
      {{least(node + 1), node + 1}, {least(second_child), second_child}}};
  std::ranges::sort(children);
  for (const auto& [lower_bound, child] : children)
    if (lower_bound < nearest)
      search(child, point, nearest);
}

}  // namespace sizes
