#pragma once

#include <span>

#include <Eigen/Core>

namespace fringe::test {

/// Whether two convex hulls have a point in common, by linear programming in integers: are there convex
/// combinations of either set of vertices that are equal? The simplex method with Bland's rule, which always
/// ends, on a tableau without fractions (J. Edmonds and J.-F. Maurras, RAIRO 31, 1997, 237). Nothing in it is
/// known to the library.
bool hulls_intersect(std::span<const Eigen::Vector3d> a, std::span<const Eigen::Vector3d> b);

}  // namespace fringe::test
