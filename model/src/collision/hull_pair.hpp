#pragma once

#include <cmath>
#include <cstddef>
#include <span>

#include <Eigen/Core>

#include "fringe/gjk.hpp"

/// Two sets of vertices with what the error bounds of both phases of a query need (model/NUMERICS.md,
/// section 13).
namespace fringe::detail {

using Vertices = std::span<const Eigen::Vector3d>;

struct HullPair {
  Vertices a;
  Vertices b;
  Eigen::Vector3d origin;  ///< a vertex of A: what coordinates are taken relative to, wherever the hulls are
  double extent;  ///< the largest coordinate of A's vertices, relative to the origin, plus that of B's

  /// What a coordinate given here may be off, in units of 2^−53 of the extent: 0 for those that are given
  /// exactly.
  double coordinate_error = 0;
};

/// The coordinate_error of vertices that a pose has moved, where the extent is that of the rotated vertices
/// and the way between the poses: four roundings of what is at most the extent, and those of the sums.
constexpr double coordinate_error_of_moved = 8;

/// Throws InputError for an empty set and for a vertex that is not finite; the message has the set's name.
void check_vertices(Vertices vertices, char name);

/// Throws InputError as check_vertices does.
HullPair hull_pair(Vertices a, Vertices b);

/// Whether products of up to six lengths of the pair neither overflow nor, where they matter, underflow.
inline bool in_safe_range(const HullPair& hulls) {
  return hulls.extent < 0x1p170 && hulls.extent > 0x1p-170;
}

/// What a vertex's rounded product with the direction, relative to the origin, is off at most, rounding the
/// direction's components by 2⁻⁵² of their magnitude included: four roundings of half of that, and the one of
/// the extent.
inline double product_error(const HullPair& hulls, const Eigen::Vector3d& direction) {
  return (0x1p-50 + 0x1p-53 * hulls.coordinate_error) * direction.lpNorm<1>() * hulls.extent;
}

struct Extreme {
  std::size_t index;
  double product;
};

/// The vertex with the largest rounded product with the direction, relative to the origin.
Extreme farthest_along(Vertices vertices, const Eigen::Vector3d& origin, const Eigen::Vector3d& direction);

}  // namespace fringe::detail
