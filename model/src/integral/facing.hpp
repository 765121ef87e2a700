#pragma once

#include <Eigen/Core>

#include "fringe/rectangle.hpp"
#include "fringe/triangle.hpp"

/// Which faces see a plate (model/NUMERICS.md, section 10).
namespace fringe::detail {

/// How a plate lies to a triangle's plane, the outward side being the one from which the vertices are
/// anticlockwise.
enum class Sight {
  outward,  ///< some point of the plate lies strictly on the outward side
  grazing,  ///< none does, but some lie in the plane itself
  none      ///< the whole plate lies strictly on the inner side
};

/// The sign of ((b − a) × (c − a))·(p − a), exactly: 1 when p lies strictly on the side from which a, b, c
/// are anticlockwise, 0 when it lies in their plane or they have none. The coordinates must be finite.
int side_of_plane(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c,
                  const Eigen::Vector3d& p);

/// Decided exactly for the plate whose corners are corner, corner + edge_u, corner + edge_v and
/// corner + edge_u + edge_v as they round. A triangle without area is grazed by every plate.
Sight sight(const Triangle& triangle, const Rectangle& plate);

}  // namespace fringe::detail
