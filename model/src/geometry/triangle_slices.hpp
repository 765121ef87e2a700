#pragma once

#include <array>
#include <cstddef>

#include <Eigen/Core>

#include "fringe/triangle.hpp"

namespace fringe::detail {

/// One of the parts into which two parallel lines cut a triangle, as at most three triangles.
struct Slice {
  std::array<Triangle, 3> triangles;
  std::size_t size = 0;

  const Triangle* begin() const { return triangles.data(); }
  const Triangle* end() const { return triangles.data() + size; }
};

/// The three parts of a triangle by the values of an affine function.
struct Slices {
  Slice below;
  Slice between;
  Slice above;
};

/// Cuts a triangle along the lines on which an affine function, given by its values at the vertices, equals
/// low and high, where low ≤ high. A triangle on which the function equals one of these values everywhere is
/// not `between`.
Slices slices(const Triangle& triangle, const Eigen::Vector3d& values, double low, double high);

/// Bisects a triangle along the median onto its longest edge.
std::array<Triangle, 2> halves(const Triangle& triangle);

}  // namespace fringe::detail
