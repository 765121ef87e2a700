#pragma once

#include <array>
#include <memory>
#include <span>

#include <Eigen/Geometry>

#include "collision/gjk_filter.hpp"
#include "fringe/convex_shape.hpp"

/// Two convex shapes in their places, as the searches take them (model/NUMERICS.md, section 13).
namespace fringe::detail {

using Vertices = std::span<const Eigen::Vector3d>;

/// Throws InputError if the set is empty or a vertex is not finite; the message contains the set's name.
void check_vertices(Vertices vertices, char name);

/// A convex shape in its place. Positions are rounded relative to an origin common to both shapes of a pair.
struct PlacedConvex {
  const SupportShape* shape;
  Vertices
      vertices;  ///< a polytope's, as given; none of a round shape. `shape` has them relative to `origin`
  const Eigen::Isometry3d* pose;
  Eigen::Vector3d origin;  ///< in the shape's own frame
  Eigen::Vector3d offset;  ///< of the moved `origin` from the common origin

  bool is_round() const { return vertices.empty(); }

  /// Computes the position of a point of the shape.
  Eigen::Vector3d position(const Eigen::Vector3d& point) const {
    return pose->linear() * (point - origin) + offset;
  }

  /// Finds a point of the shape, in its own frame, that is farthest along a direction up to rounding (the
  /// support mapping).
  Eigen::Vector3d farthest_along(const Eigen::Vector3d& direction) const;

  /// Returns the shape for the filter.
  PlacedShape filtered() const { return {shape, pose->data()}; }

  /// Returns the point that the filter has found: by its index in a hull, whose coordinates may be rounded.
  Eigen::Vector3d filter_point(std::uint32_t index, const double* point) const {
    return shape->kind == ShapeKind::hull ? vertices[index] : Eigen::Vector3d(point);
  }
};

/// The two shapes of a query.
struct ConvexPair {
  PlacedConvex a;
  PlacedConvex b;
  double extent;  ///< bounds the length of all differences of their points

  bool is_round() const { return a.is_round() || b.is_round(); }

  /// Tests whether products of up to six lengths of the pair neither overflow nor, where it matters,
  /// underflow.
  bool is_in_safe_range() const { return extent < 0x1p170 && extent > 0x1p-170; }

  /// Bounds the error of the difference of two positions and of its product with a unit vector, also with one
  /// that farthest_along has maximised.
  double rounding() const { return 0x1p-47 * extent; }

  Eigen::Vector3d difference(const PointPair& pair) const { return a.position(pair.a) - b.position(pair.b); }

  /// Finds the points whose difference is farthest along a direction, up to rounding.
  PointPair farthest_along(const Eigen::Vector3d& direction) const {
    return {a.farthest_along(direction), b.farthest_along(-direction)};
  }

  /// Returns the points of a pair that a search in floating point has found.
  PointPair filter_points(const SupportPair& found) const {
    return {a.filter_point(found.a, found.on_a), b.filter_point(found.b, found.on_b)};
  }

  /// Returns the simplex of one pair with which a search starts: the points that face the other shape.
  Simplex start() const;
};

/// Prepares two shapes in poses, all of which must outlive the pair.
ConvexPair convex_pair(const ConvexShape& a, const Eigen::Isometry3d& pose_a, const ConvexShape& b,
                       const Eigen::Isometry3d& pose_b);

/// A hull for one query, from vertices that must outlive it. Throws InputError as check_vertices does.
class PassingHull {
 public:
  PassingHull(Vertices vertices, const Eigen::Vector3d& origin, char name);
  PassingHull(const PassingHull&) = delete;
  PassingHull& operator=(const PassingHull&) = delete;

  PlacedConvex placed() const;
  GivenHull given() const { return {&shape_, vertices_.data()->data()}; }
  double bounding_radius() const { return shape_.bounding_radius; }

 private:
  Vertices vertices_;
  Eigen::Vector3d origin_;
  std::array<double, 3 * SupportShape::few_vertices> few_coordinates_;
  std::unique_ptr<double[]> many_coordinates_;
  SupportShape shape_{};
};

/// Two hulls for one query, relative to a vertex of A. Throws InputError as check_vertices does.
class PassingHulls {
 public:
  PassingHulls(Vertices a, Vertices b);

  ConvexPair pair() const { return {a_.placed(), b_.placed(), a_.bounding_radius() + b_.bounding_radius()}; }
  const PassingHull& a() const { return a_; }
  const PassingHull& b() const { return b_; }

 private:
  PassingHull a_, b_;
};

}  // namespace fringe::detail
