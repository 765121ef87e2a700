#pragma once

#include <memory>
#include <span>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "fringe/gjk.hpp"

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

  /// Makes a box swept by a ball. `core` are the sides of the box, which may be zero: a segment gives a
  /// capsule. Throws InputError for a radius of zero.
  static ConvexShape rounded_cuboid(const Eigen::Vector3d& core, double radius);

  /// Makes an ellipsoid with its axes along x, y and z. Throws InputError for a semi-axis of zero.
  static ConvexShape ellipsoid(const Eigen::Vector3d& semi_axes);

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

/// Decides as intersect() does, and returns the proof.
GjkAnswer gjk_intersects(const ConvexShape& a, const Eigen::Isometry3d& pose_a, const ConvexShape& b,
                         const Eigen::Isometry3d& pose_b);

/// Computes the shortest distance of two convex shapes, each moved by a pose, and the witness points.
///
/// The search runs in floating point, with bounds of every rounding, until `distance` and `lower_bound`
/// differ by at most 1e-12 of the distance. Where rounding prevents this, two polytopes are solved in twice
/// the precision or, if they are nearer than about 1e-4 of their size and distance, in integers: the distance
/// is then accurate to three units in its last place. For round shapes the two bounds show the remaining
/// error, some 1e-14 of the shapes' size and distance. Whether the shapes meet is decided
/// as intersect() decides it. The poses must be rotations to 1e-9. Throws InputError for one that is not
/// finite, and for round shapes whose size and distance are not within 2^±170.
GjkDistance gjk_distance(const ConvexShape& a, const Eigen::Isometry3d& pose_a, const ConvexShape& b,
                         const Eigen::Isometry3d& pose_b);

/// Tests whether the certificate proves the answer. Decides in rational arithmetic (roots between rational
/// bounds) from the given numbers alone, using nothing of the search that found the answer.
bool proves(const GjkAnswer& answer, const ConvexShape& a, const Eigen::Isometry3d& pose_a,
            const ConvexShape& b, const Eigen::Isometry3d& pose_b);

}  // namespace fringe
