#pragma once

#include <cstddef>
#include <ostream>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "fringe/gjk.hpp"
#include "geometry.hpp"

/// Pairs of convex shapes, in classes that make collision queries difficult, and the exact answer.
namespace fringe::test {

using Points = std::vector<Eigen::Vector3d>;

struct ShapePair {
  Points a;
  Points b;
};

struct PairClass {
  std::string name;
  ShapePair (*make)(Random&);
};

/// Prints the class by its name instead of its bytes.
inline void PrintTo(const PairClass& pairs, std::ostream* out) {
  *out << pairs.name;
}

std::span<const PairClass> pair_classes();

/// Returns 1 to `most` points in the cube [−1, 1]³, or in a random plane, line or point of it.
Points any_shape(Random& random, std::size_t most);

/// Returns the corners of a box about the origin, x slowest.
Points corners_of_box(const Eigen::Vector3d& half_widths);

Points moved(const Points& points, const Eigen::Isometry3d& motion);

/// Returns a random integer from 0 to limit − 1.
std::size_t below(Random& random, std::size_t limit);

/// Multiplies all points by the factor and then translates them.
ShapePair placed(const ShapePair& pair, double factor, const Eigen::Vector3d& offset);

/// Computes the distance of two hulls by the library's algorithm in exact numbers alone.
GjkDistance exact_distance(const Points& a, const Points& b);

/// Returns whether two convex hulls have a point in common, by linear programming in integers: it looks for
/// equal convex combinations of the two sets of vertices. Uses the simplex method with Bland's rule, which
/// always terminates, on a tableau without fractions (J. Edmonds and J.-F. Maurras, RAIRO 31, 1997, 237). It
/// shares no code with the library.
bool hulls_intersect(std::span<const Eigen::Vector3d> a, std::span<const Eigen::Vector3d> b);

}  // namespace fringe::test
