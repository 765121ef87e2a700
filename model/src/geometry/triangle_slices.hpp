#pragma once

#include <array>
#include <cstddef>

#include <Eigen/Core>

#include "fringe/triangle.hpp"

namespace fringe::detail {

/// At most three triangles: what two parallel cuts leave of one.
struct Slice {
  std::array<Triangle, 3> triangles;
  std::size_t size = 0;

  const Triangle* begin() const { return triangles.data(); }
  const Triangle* end() const { return triangles.data() + size; }
};

/// The three parts of a triangle, by the values of an affine function.
struct Slices {
  Slice below;
  Slice between;
  Slice above;
};

/// Cuts a triangle along the lines on which an affine function, given by its values at the vertices, takes
/// the values low ≤ high. A triangle on which the function has one of these values everywhere is not between.
Slices slices(const Triangle& triangle, const Eigen::Vector3d& values, double low, double high);

/// The parts of a triangle on either side of the median onto its longest edge.
std::array<Triangle, 2> halves(const Triangle& triangle);

}  // namespace fringe::detail
