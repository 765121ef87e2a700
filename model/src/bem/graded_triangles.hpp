#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "fringe/triangle.hpp"

namespace fringe::detail {

/// An edge near which the charge density grows like the distance from it to the power −exponent.
struct SharpEdge {
  Eigen::Vector3d from;
  Eigen::Vector3d to;
  double exponent;
};

/// Estimates the charge density of a surface before anything is solved for, by its growth towards the sharp
/// edges (model/BOUNDARY_ELEMENTS.md, section 9).
class EdgeDensity {
 public:
  explicit EdgeDensity(std::span<const Triangle> triangles);

  /// Returns the density at a point of a triangle, in arbitrary units.
  double at(std::size_t triangle, const Eigen::Vector3d& point) const;

  /// Returns the sharp edges around a triangle's part of the surface. The parts are what the sharp edges
  /// separate.
  const std::vector<SharpEdge>& edges_around(std::size_t triangle) const {
    return edges_[part_of_[triangle]];
  }

 private:
  double size_;                                ///< the square root of the area
  std::vector<std::size_t> part_of_;           ///< for each triangle
  std::vector<std::vector<SharpEdge>> edges_;  ///< around each part
};

/// Divides the triangles of a surface towards its sharp edges, until one density on each would miss about the
/// fraction `missing` of the energy, evenly spread over all. Stops when there are `most` triangles
/// (model/BOUNDARY_ELEMENTS.md, section 9).
std::vector<Triangle> graded_triangles(std::span<const Triangle> triangles, double missing, std::size_t most);

}  // namespace fringe::detail
