#pragma once

#include <cmath>
#include <cstddef>
#include <span>

#include <Eigen/Core>

#include "fringe/gjk.hpp"

/// Two sets of vertices with the lengths that the error bounds of both phases of a query need
/// (model/NUMERICS.md, section 13).
namespace fringe::detail {

using Vertices = std::span<const Eigen::Vector3d>;

struct HullPair {
  Vertices a;
  Vertices b;
  Eigen::Vector3d origin;  ///< a vertex of A; coordinates are taken relative to it, wherever the hulls are
  double extent;  ///< the largest coordinate of A's vertices, relative to the origin, plus that of B's

  /// Bound on the error of the coordinates given here, in units of 2^−53 of the extent; 0 if they are exact.
  double coordinate_error = 0;
};

/// The coordinate_error of vertices that a pose has moved, where the extent is that of the rotated vertices
/// plus the distance between the poses: four roundings of at most the extent each, and those of the sums.
constexpr double coordinate_error_of_moved = 8;

/// Throws InputError if the set is empty or a vertex is not finite; the message contains the set's name.
void check_vertices(Vertices vertices, char name);

/// Prepares two sets of vertices for a query. Throws InputError as check_vertices does.
HullPair hull_pair(Vertices a, Vertices b);

/// Tests whether products of up to six lengths of the pair neither overflow nor, where it matters, underflow.
inline bool in_safe_range(const HullPair& hulls) {
  return hulls.extent < 0x1p170 && hulls.extent > 0x1p-170;
}

/// Bounds the error of a vertex's rounded product with the direction, relative to the origin. It includes a
/// rounding of the direction's components by 2⁻⁵² of their magnitude, four roundings by half of that, and the
/// rounding of the extent.
inline double product_error(const HullPair& hulls, const Eigen::Vector3d& direction) {
  return (0x1p-50 + 0x1p-53 * hulls.coordinate_error) * direction.lpNorm<1>() * hulls.extent;
}

/// A support point: its index and its product with the direction.
struct Extreme {
  std::size_t index;
  double product;
};

/// Finds the vertex with the largest rounded product with the direction, relative to the origin (the support
/// mapping).
Extreme farthest_along(Vertices vertices, const Eigen::Vector3d& origin, const Eigen::Vector3d& direction);

}  // namespace fringe::detail
