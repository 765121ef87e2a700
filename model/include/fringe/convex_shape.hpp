#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <span>
#include <variant>

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace fringe {

namespace detail {
struct ConvexShapeData;
}

/// A convex shape in its own frame, prepared for many queries. It is centred at the origin with z as its
/// axis, like the shapes of a scene (fringe/shape.hpp), but truly round. Copies share the prepared data.
///
/// Every function that makes one throws InputError for lengths that are negative or not finite.
class ConvexShape {
 public:
  /// Makes the convex hull of vertices. Throws InputError if there are none or one is not finite.
  static ConvexShape hull(std::span<const Eigen::Vector3d> vertices);

  /// Makes a box with these sides. Some may be zero: a rectangle is a box without height.
  static ConvexShape cuboid(const Eigen::Vector3d& sides);

  static ConvexShape ball(double radius);
  static ConvexShape cylinder(double radius, double height);

  /// Makes a cone. The base lies at z = −height/2, the apex at +height/2.
  static ConvexShape cone(double radius, double height);

  /// Makes the convex hull of a sector of a ring about z, from −degrees/2 to +degrees/2. Its outer surface is
  /// round, the surface between its inner ends flat. Throws InputError unless 0 < degrees < 180 and
  /// inner_radius ≤ outer_radius.
  static ConvexShape arc_piece(double inner_radius, double outer_radius, double height, double degrees);

  /// Tests whether some of the surface is round. Queries are decided exactly only if both shapes are
  /// polytopes.
  bool is_round() const;

  const detail::ConvexShapeData& data() const { return *data_; }

 private:
  explicit ConvexShape(std::shared_ptr<const detail::ConvexShapeData> data) : data_(std::move(data)) {}

  std::shared_ptr<const detail::ConvexShapeData> data_;
};

/// Tests whether two convex shapes, each moved by a pose, have a point in common; touching counts.
///
/// For two polytopes the answer is exact for the given numbers, those of the poses' matrices included. With
/// round shapes it is proven unless their gap or overlap is so small (some 1e-14 of their size and distance)
/// that rounding hides it; then the answer is "yes". The poses must be rotations to 1e-9. Throws InputError
/// for a pose that is not finite.
bool intersect(const ConvexShape& a, const Eigen::Isometry3d& pose_a, const ConvexShape& b,
               const Eigen::Isometry3d& pose_b);

/// A point of each shape, in the shape's own frame.
struct PointPair {
  Eigen::Vector3d a;
  Eigen::Vector3d b;
};

/// One to four pairs; the simplex is the convex hull of the differences a − b of the moved points.
struct PointSimplex {
  std::array<PointPair, 4> pairs{};
  std::size_t size = 0;
};

/// The shapes are disjoint: direction·a < direction·b for all points a of A and b of B, in the world.
struct ShapesSeparated {
  Eigen::Vector3d direction;
};

/// The shapes are disjoint, but so close that no direction of three doubles was found to separate them. The
/// exact vector from n to the origin separates them, where n is the point nearest to the origin on the line
/// or plane through the two or three points of the simplex, or its only point.
struct ShapesSeparatedBySimplex {
  PointSimplex simplex;
};

/// The shapes have a point in common: the simplex contains the origin.
struct ShapesMeet {
  PointSimplex simplex;
};

/// Rounding hides whether the shapes are disjoint. They overlap by at most `overlap` along the direction (of
/// length 1 up to rounding): direction·a ≤ direction·b + overlap for all points. The distance of the simplex
/// from the origin is at most `gap`.
struct ShapesUndecided {
  Eigen::Vector3d direction;
  double overlap;
  PointSimplex simplex;
  double gap;
};

using ShapeCertificate = std::variant<ShapesSeparated, ShapesSeparatedBySimplex, ShapesMeet, ShapesUndecided>;

struct ShapeAnswer {
  bool intersects;
  ShapeCertificate certificate;
};

/// Decides as intersect() does, and returns the proof.
ShapeAnswer gjk_intersects(const ConvexShape& a, const Eigen::Isometry3d& pose_a, const ConvexShape& b,
                           const Eigen::Isometry3d& pose_b);

/// The shortest distance of two convex shapes, with bounds that prove it.
struct ShapeDistance {
  double distance;            ///< distance of the witness points; 0 if the shapes have a point in common
  double lower_bound;         ///< proven lower bound of the distance
  Eigen::Vector3d direction;  ///< of length 1 up to rounding, from A to B; may be zero if lower_bound is
  Eigen::Vector3d witness_a;  ///< a point of A in the world, up to rounding
  Eigen::Vector3d witness_b;  ///< a point of B; if the shapes meet, the same point up to rounding
  bool exact;  ///< solved in integers; otherwise direction·a + lower_bound ≤ direction·b for all points
};

/// Computes the shortest distance of two convex shapes, each moved by a pose, and the witness points.
///
/// The search runs in floating point, with bounds of every rounding, until `distance` and `lower_bound`
/// differ by at most 1e-12 of the distance. Where rounding prevents this, two polytopes are solved in
/// integers: the distance is then accurate to three units in its last place. For round shapes the two bounds
/// show the remaining error, some 1e-14 of the shapes' size and distance. Whether the shapes meet is decided
/// as intersect() decides it. The poses must be rotations to 1e-9. Throws InputError for one that is not
/// finite, and for round shapes whose size and distance are not within 2^±170.
ShapeDistance gjk_distance(const ConvexShape& a, const Eigen::Isometry3d& pose_a, const ConvexShape& b,
                           const Eigen::Isometry3d& pose_b);

/// Tests whether the certificate proves the answer. Decides in rational arithmetic (roots between rational
/// bounds) from the given numbers alone, using nothing of the search that found the answer.
bool proves(const ShapeAnswer& answer, const ConvexShape& a, const Eigen::Isometry3d& pose_a,
            const ConvexShape& b, const Eigen::Isometry3d& pose_b);

}  // namespace fringe
