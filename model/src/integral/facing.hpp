#pragma once

#include <Eigen/Core>

#include "fringe/rectangle.hpp"
#include "fringe/triangle.hpp"

/// Decides which faces of a surface see a plate (model/NUMERICS.md, section 10).
namespace fringe::detail {

/// Position of a plate relative to a triangle's plane. The outward side is the one from which the vertices
/// appear anticlockwise.
enum class Sight {
  outward,  ///< some point of the plate lies strictly on the outward side
  grazing,  ///< no point lies on the outward side, but some lie in the plane itself
  none      ///< the whole plate lies strictly on the inner side
};

/// Computes the sign of ((b − a) × (c − a))·(p − a) exactly: 1 when p lies strictly on the side from which a,
/// b, c are anticlockwise, −1 on the other side, 0 when p lies in their plane or a, b, c are collinear. The
/// coordinates must be finite.
int side_of_plane(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c,
                  const Eigen::Vector3d& p);

/// Decides how a plate lies relative to a triangle's plane. The decision is exact for the plate with the
/// corners corner, corner + edge_u, corner + edge_v and corner + edge_u + edge_v as rounded to doubles. For a
/// triangle without area the result is always Sight::grazing.
Sight sight(const Triangle& triangle, const Rectangle& plate);

}  // namespace fringe::detail
