#pragma once

#include <array>

#include <Eigen/Geometry>

#include "collision/exact_vector.hpp"
#include "collision/float_search.hpp"
#include "collision/hull_pair.hpp"

/// GJK in integers, which decides the queries that floating point cannot (model/NUMERICS.md, section 13).
namespace fringe::detail {

/// The exact positions of vertices.
class ExactVertices {
 public:
  /// Takes the vertices as they are.
  explicit ExactVertices(Vertices vertices);

  /// Moves the vertices by the matrix of a pose, which must outlive this object.
  ExactVertices(Vertices vertices, const Eigen::Isometry3d& pose);

  /// Returns a common unit: all coordinates of all positions are multiples of 2^unit().
  int unit() const { return unit_; }

  /// Returns a position in units of 2^unit, which must not be above unit().
  ExactVector position(std::size_t index, int unit) const;

 private:
  Vertices vertices_;
  const Eigen::Isometry3d* pose_ = nullptr;
  int own_unit_;         ///< unit of the coordinates before they are moved
  int matrix_unit_ = 0;  ///< unit of the rotation matrix
  int unit_;
};

/// Two hulls with positions in integers.
struct ExactHulls {
  const HullPair& hulls;  ///< the rounded positions of the vertices
  ExactVertices a;
  ExactVertices b;
  int unit;  ///< coordinates count in units of 2^unit
};

/// Prepares hulls whose positions are given exactly.
ExactHulls exact_hulls(const HullPair& hulls);

/// Prepares moved hulls; `hulls` contains the rounded positions.
ExactHulls exact_hulls(const HullPair& hulls, const ExactVertices& a, const ExactVertices& b);

/// A point of the Minkowski difference: Σ weightsᵢ (aᵢ − bᵢ)/total over the pairs of the simplex, all weights
/// positive.
struct ExactNearest {
  PairSimplex simplex;
  std::array<Integer, 4> weights;
  Integer total;
  ExactVector point;  ///< times `total`, in units of 2^unit
};

/// Runs GJK from any simplex, or an empty one, and returns the point of the Minkowski difference nearest to
/// the origin. With the goal `decision` and disjoint hulls, it returns any point p for which p·q > 0 for all
/// points q of the difference.
ExactNearest exact_search(const ExactHulls& exact, const PairSimplex& start, Goal goal);

/// Computes the point's distance from the origin and the witness points, that is the points of the hulls
/// whose difference it is. The distance is accurate to three units in the last place, each coordinate to one.
HullDistance rounded_distance(const ExactHulls& exact, const ExactNearest& nearest);

/// Tests whether direction·a < direction·b for all vertices a and b.
bool separates(const ExactHulls& exact, const Eigen::Vector3d& direction);

}  // namespace fringe::detail
