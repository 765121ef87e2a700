#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <variant>

#include <Eigen/Core>

/// Collisions and distances of convex hulls, and the answers of all such queries. The same queries of convex
/// shapes in poses are in fringe/convex_shape.hpp.
namespace fringe {

/// A point of A and a point of B. Hulls are given by their vertices; points of shapes with a pose are given
/// before the pose moves them.
struct PointPair {
  Eigen::Vector3d a;
  Eigen::Vector3d b;
};

/// A simplex of the Minkowski difference A − B: the convex hull of the differences a − b of one to four
/// pairs, of moved points where there are poses. The points of a polytope are vertices.
struct Simplex {
  std::array<PointPair, 4> pairs{};
  std::size_t size = 0;
};

/// A and B are disjoint: direction·a < direction·b for all their points, exactly.
struct SeparatingDirection {
  Eigen::Vector3d direction;
};

/// A and B are disjoint, but so close that no direction of three doubles was found to separate them. The
/// exact vector from n to the origin separates them, where n is the point nearest to the origin on the line
/// or plane through the two or three points of the simplex, or its only point.
struct SeparatingSimplex {
  Simplex simplex;
};

/// A and B have a point in common: the simplex contains the origin.
struct SimplexAroundOrigin {
  Simplex simplex;
};

/// Rounding hides whether A and B, one of them round, are disjoint. They overlap by at most `overlap` along
/// the direction (of length 1 up to rounding): direction·a ≤ direction·b + overlap for all points. The
/// distance of the simplex from the origin is at most `gap`.
struct HiddenByRounding {
  Eigen::Vector3d direction;
  double overlap;
  Simplex simplex;
  double gap;
};

using GjkCertificate =
    std::variant<SeparatingDirection, SeparatingSimplex, SimplexAroundOrigin, HiddenByRounding>;

struct GjkAnswer {
  bool intersects;
  GjkCertificate certificate;
};

/// The shortest distance, with bounds that prove it.
struct GjkDistance {
  double distance;            ///< distance of the witness points; 0 if A and B have a point in common
  double lower_bound;         ///< proven lower bound of the distance
  Eigen::Vector3d direction;  ///< of length 1 up to rounding, from A to B; may be zero if lower_bound is
  Eigen::Vector3d witness_a;  ///< a point of A, moved by its pose, up to rounding
  Eigen::Vector3d witness_b;  ///< a point of B; if A and B intersect, the same point up to rounding
  bool exact;  ///< accurate to three units in the last place; otherwise direction·a + lower_bound ≤
               ///< direction·b for all points
};

/// Tests whether the convex hulls of two sets of vertices have a point in common; touching counts. The answer
/// is exact for the given coordinates, whatever their magnitude, and always comes with a proof (Gilbert,
/// Johnson and Keerthi, IEEE Journal of Robotics and Automation 4, 1988, 193; thesis chapter 2;
/// model/NUMERICS.md, section 13). Throws InputError for an empty set and for a vertex that is not finite.
GjkAnswer gjk_intersects(std::span<const Eigen::Vector3d> a, std::span<const Eigen::Vector3d> b);

/// Computes the shortest distance between the convex hulls of two sets of vertices, in their unit. The
/// nearest points are found in twice the precision or, where that may not suffice, exactly, and then rounded:
/// the distance is accurate to three units in its last place, each coordinate of a witness to one. It is 0 if
/// and only if the hulls have a point in common; both witnesses are then the same point. A distance above the
/// largest double is +∞. Throws InputError as gjk_intersects does.
GjkDistance gjk_distance(std::span<const Eigen::Vector3d> a, std::span<const Eigen::Vector3d> b);

/// Tests whether the certificate proves the answer. Decides in rational arithmetic from the coordinates
/// alone, using nothing of the search that found the answer. Points that are not vertices prove nothing.
bool proves(const GjkAnswer& answer, std::span<const Eigen::Vector3d> a, std::span<const Eigen::Vector3d> b);

}  // namespace fringe
