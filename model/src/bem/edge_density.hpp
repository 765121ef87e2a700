#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "fringe/triangle.hpp"

namespace fringe::detail {

/// An edge that the charge grows towards, by the distance from it to the power −exponent.
struct SharpEdge {
  Eigen::Vector3d from;
  Eigen::Vector3d to;
  double exponent;
};

/// What is known of the charge of a surface before anything is solved for: how it grows towards the sharp
/// edges (model/BOUNDARY_ELEMENTS.md, section 9).
class EdgeDensity {
 public:
  explicit EdgeDensity(std::span<const Triangle> triangles);

  /// The density at a point of a triangle, in units without meaning.
  double at(std::size_t triangle, const Eigen::Vector3d& point) const;

  /// The edges around the part of the surface without sharp edges in it that a triangle belongs to.
  const std::vector<SharpEdge>& edges_around(std::size_t triangle) const {
    return edges_[part_of_[triangle]];
  }

 private:
  double size_;                                ///< the root of the area
  std::vector<std::size_t> part_of_;           ///< of each triangle
  std::vector<std::vector<SharpEdge>> edges_;  ///< around each part
};

}  // namespace fringe::detail
