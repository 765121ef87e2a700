#pragma once

#include <limits>
#include <optional>

#include <Eigen/Core>

#include "collision/convex_pair.hpp"
#include "collision/gjk_iteration.hpp"
#include "numeric/dyadic.hpp"

/// The Minkowski difference A − B of two convex shapes, for the searches by gjk() that floating point leaves:
/// exact for polytopes, and exact in points of round shapes.
namespace fringe::detail {

/// Exact positions of a shape's points.
struct ExactPlacement {
  bool in_place;  ///< whether the pose is the identity
  Eigen::Matrix<Dyadic, 3, 3> rotation;
  Vector<Dyadic> translation;

  explicit ExactPlacement(const Eigen::Isometry3d& pose);
  Vector<Dyadic> position(const Eigen::Vector3d& point) const;

  /// Turns a direction into the shape's own frame: its products with points change by a constant only.
  Vector<Dyadic> turned_back(const Vector<Dyadic>& direction) const;
};

/// A difference with exact positions, of the given numbers of vertices and poses.
class ExactDifference {
 public:
  explicit ExactDifference(const ConvexPair& pair);

  Vector<Dyadic> point(const PointPair& pair) const { return a_.position(pair.a) - b_.position(pair.b); }

  /// Computes the distance of a face's nearest point from the origin and the witness points. The distance is
  /// accurate to three units in the last place, each coordinate to one.
  GjkDistance distance(const NearestFace<Dyadic>& face) const;

 protected:
  const ConvexPair& pair_;
  ExactPlacement a_, b_;
};

/// What a search of two polytopes is for.
enum class Goal {
  decision,  ///< decide whether they intersect: any point p suffices for which p·q > 0 for all differences q
  distance   ///< find the nearest points, too
};

/// The difference of two polytopes, whose vertices are compared exactly. Every nearest point is that of one
/// of finitely many simplices and none occurs twice, so the search ends.
class PolytopeDifference : public ExactDifference {
 public:
  PolytopeDifference(const ConvexPair& pair, Goal goal) : ExactDifference(pair), goal_(goal) {}

  std::optional<PointPair> next_pair(const NearestFace<Dyadic>& face) const;

  /// Tests whether direction·a < direction·b for all vertices a and b.
  bool separates(const Eigen::Vector3d& direction) const;

 private:
  /// Finds the vertices whose difference is farthest along a direction.
  PointPair farthest_along(const Vector<Dyadic>& direction) const;

  Goal goal_;
};

/// The difference of two shapes with round surfaces. Their support points are rounded, and moved inwards so
/// that they certainly belong to the shapes; from there on the search is exact. It ends with an answer, or
/// when another pair would gain no more than rounding.
class RoundDifference : public ExactDifference {
 public:
  explicit RoundDifference(const ConvexPair& pair) : ExactDifference(pair) {}

  std::optional<PointPair> next_pair(const NearestFace<Dyadic>& face);

  /// Moves the points of round shapes inwards.
  PointPair inside(const PointPair& pair) const;

  /// Returns what the search has shown: a common point, a separating direction, or that rounding hides it.
  GjkAnswer answer() const { return answer_; }

 private:
  GjkAnswer answer_{};
  HiddenByRounding hidden_{Eigen::Vector3d::Zero(), std::numeric_limits<double>::infinity(), {}, 0};
  int round_ = 0;
};

}  // namespace fringe::detail
