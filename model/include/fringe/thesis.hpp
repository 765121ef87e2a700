#pragma once

#include <optional>
#include <span>

#include <Eigen/Core>

/// The thesis' own algorithm for collisions, for comparison.
namespace fringe {

/// Runs the thesis' Algorithm 2.1 with appendix C, in doubles and as printed, except that the regions in
/// front of a tetrahedron's faces are taken as the complement of the region inside. Returns nothing if it has
/// not ended after `most_rounds` support points; at times it never ends. It is often wrong where the hulls
/// touch: use gjk_intersects (fringe/gjk.hpp). Throws InputError for an empty set of vertices and for a
/// vertex that is not finite.
std::optional<bool> thesis_gjk_intersects(std::span<const Eigen::Vector3d> a,
                                          std::span<const Eigen::Vector3d> b, int most_rounds = 1000);

}  // namespace fringe
