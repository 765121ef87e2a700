#pragma once

#include <span>

#include <Eigen/Core>

namespace fringe::test {

/// Returns whether two convex hulls have a point in common, by linear programming in integers: it looks for
/// equal convex combinations of the two sets of vertices. Uses the simplex method with Bland's rule, which
/// always terminates, on a tableau without fractions (J. Edmonds and J.-F. Maurras, RAIRO 31, 1997, 237). It
/// shares no code with the library.
bool hulls_intersect(std::span<const Eigen::Vector3d> a, std::span<const Eigen::Vector3d> b);

}  // namespace fringe::test
