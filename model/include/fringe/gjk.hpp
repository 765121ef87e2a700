#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <variant>

#include <Eigen/Core>

namespace fringe {

/// A point a − b of the Minkowski difference A − B, given by the indices of a vertex of A and one of B.
struct VertexPair {
  std::size_t a;
  std::size_t b;
};

/// One to four pairs; the simplex is the convex hull of their points.
struct PairSimplex {
  std::array<VertexPair, 4> pairs{};
  std::size_t size = 0;
};

/// The hulls are disjoint: direction·a < direction·b for every vertex a of A and b of B, exactly.
struct SeparatingDirection {
  Eigen::Vector3d direction;
};

/// The hulls are disjoint, but so close that no direction of three doubles was found to separate them. The
/// exact vector from n to the origin separates them, where n is the point nearest to the origin on the line
/// or plane through the two or three points of the simplex, or its only point.
struct SeparatingSimplex {
  PairSimplex simplex;
};

/// The hulls have a point in common: the simplex contains the origin.
struct SimplexAroundOrigin {
  PairSimplex simplex;
};

using GjkCertificate = std::variant<SeparatingDirection, SeparatingSimplex, SimplexAroundOrigin>;

struct GjkAnswer {
  bool intersects;
  GjkCertificate certificate;
};

/// Tests whether the convex hulls of two sets of vertices have a point in common; touching counts. The answer
/// is exact for the given coordinates, whatever their magnitude, and always comes with a proof (Gilbert,
/// Johnson and Keerthi, IEEE Journal of Robotics and Automation 4, 1988, 193; thesis chapter 2;
/// model/NUMERICS.md, section 13). Throws InputError for an empty set and for a vertex that is not finite.
GjkAnswer gjk_intersects(std::span<const Eigen::Vector3d> a, std::span<const Eigen::Vector3d> b);

/// Runs the thesis' Algorithm 2.1 with appendix C, in doubles and as printed, except that the regions in
/// front of a tetrahedron's faces are taken as the complement of the region inside. Returns nothing if it has
/// not ended after `most_rounds` support points; at times it never ends. It is often wrong where the hulls
/// touch: use gjk_intersects. Throws InputError as that does.
std::optional<bool> thesis_gjk_intersects(std::span<const Eigen::Vector3d> a,
                                          std::span<const Eigen::Vector3d> b, int most_rounds = 1000);

/// Tests whether the certificate proves the answer. Decides in rational arithmetic from the coordinates
/// alone, using nothing of the search that found the answer. Indices out of range prove nothing.
bool proves(const GjkAnswer& answer, std::span<const Eigen::Vector3d> a, std::span<const Eigen::Vector3d> b);

/// The shortest distance of two hulls, and the witness points: a point of each hull.
struct HullDistance {
  double distance;  ///< in the unit of the vertices; 0 if and only if the hulls have a point in common
  Eigen::Vector3d witness_a;
  Eigen::Vector3d witness_b;
};

/// Computes the shortest distance between the convex hulls of two sets of vertices. The nearest points are
/// found exactly and then rounded: the distance is accurate to three units in its last place, each coordinate
/// of a witness to one. A distance above the largest double is +∞. For hulls that intersect both witnesses
/// are the same point. Throws InputError as gjk_intersects does.
HullDistance gjk_distance(std::span<const Eigen::Vector3d> a, std::span<const Eigen::Vector3d> b);

}  // namespace fringe
