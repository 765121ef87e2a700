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

/// A convex shape, prepared for many queries, in its own frame: centred at the origin, z the axis, as the
/// shapes of a scene (fringe/shape.hpp) but truly round. Copies share what was prepared.
///
/// Every function that makes one throws InputError for lengths that are negative or not finite.
class ConvexShape {
 public:
  /// The convex hull of vertices. Throws InputError for none and for one that is not finite.
  static ConvexShape hull(std::span<const Eigen::Vector3d> vertices);

  /// A box with these sides; some may be zero: a rectangle is a box without height.
  static ConvexShape cuboid(const Eigen::Vector3d& sides);

  static ConvexShape ball(double radius);
  static ConvexShape cylinder(double radius, double height);

  /// The base lies at z = −height/2, the apex at +height/2.
  static ConvexShape cone(double radius, double height);

  /// The convex hull of a sector of a ring about z, from −degrees/2 to +degrees/2: round outside, between the
  /// inner ends flat. Throws InputError unless 0 < degrees < 180 and inner_radius ≤ outer_radius.
  static ConvexShape arc_piece(double inner_radius, double outer_radius, double height, double degrees);

  /// Whether some of the surface is round. Queries are decided exactly only where both surfaces are flat.
  bool is_round() const;

  const detail::ConvexShapeData& data() const { return *data_; }

 private:
  explicit ConvexShape(std::shared_ptr<const detail::ConvexShapeData> data) : data_(std::move(data)) {}

  std::shared_ptr<const detail::ConvexShapeData> data_;
};

/// Whether two convex shapes, each moved by a pose, have a point in common; touching counts.
///
/// Where both surfaces are flat the answer is exact for the numbers given, those of the poses' matrices
/// included. With round ones it is proven unless the shapes' gap or overlap is so small (some 1e-14 of their
/// size and distance) that rounding hides it; then it is "yes". The poses must be rotations to 1e-9. Throws
/// InputError for one that is not finite.
bool intersect(const ConvexShape& a, const Eigen::Isometry3d& pose_a, const ConvexShape& b,
               const Eigen::Isometry3d& pose_b);

/// A point of either shape, each in the shape's own frame.
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

/// The shapes are disjoint, but so close that no direction of three doubles was found to separate them. One
/// that does is the exact vector from n to the origin, n the point nearest to the origin on the line or plane
/// through the two or three points of the simplex, or the only one.
struct ShapesSeparatedBySimplex {
  PointSimplex simplex;
};

/// The shapes have a point in common: the simplex holds the origin.
struct ShapesMeet {
  PointSimplex simplex;
};

/// Rounding hides whether the shapes are disjoint. They overlap by no more than `overlap` along the direction
/// (of length 1 to rounding): direction·a ≤ direction·b + overlap for all points; and the simplex comes as
/// close to the origin as `gap`.
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

/// As intersect(), with the proof.
ShapeAnswer gjk_intersects(const ConvexShape& a, const Eigen::Isometry3d& pose_a, const ConvexShape& b,
                           const Eigen::Isometry3d& pose_b);

/// The shortest distance of two convex shapes, and what proves it.
struct ShapeDistance {
  double distance;            ///< that of the witnesses; 0 where the shapes have a point in common
  double lower_bound;         ///< the shapes are not nearer
  Eigen::Vector3d direction;  ///< of length 1 to rounding, from A to B; may be zero where lower_bound is
  Eigen::Vector3d witness_a;  ///< a point of A in the world, to rounding
  Eigen::Vector3d witness_b;  ///< of B; where the shapes meet, the same to rounding
  bool exact;  ///< solved in integers; otherwise direction·a + lower_bound ≤ direction·b for all points
};

/// The shortest distance of two convex shapes, each moved by a pose, with the points where it is.
///
/// Found in floating point, with bounds of every rounding that leave at most 1e-12 of it between `distance`
/// and `lower_bound`. Where they would leave more, shapes with flat surfaces are solved in integers: the
/// distance is then right to three units in its last place. With round ones the two bounds say how much is
/// left; it is some 1e-14 of the shapes' size and distance. Whether the shapes meet is what intersect() says.
/// The poses are as there. Throws InputError for one that is not finite, and for round shapes whose size and
/// distance are not within 2^±170.
ShapeDistance gjk_distance(const ConvexShape& a, const Eigen::Isometry3d& pose_a, const ConvexShape& b,
                           const Eigen::Isometry3d& pose_b);

/// Whether the certificate proves the answer. Decided in rational arithmetic (roots between rational bounds)
/// from the numbers given alone, with nothing of what found the answer.
bool proves(const ShapeAnswer& answer, const ConvexShape& a, const Eigen::Isometry3d& pose_a,
            const ConvexShape& b, const Eigen::Isometry3d& pose_b);

}  // namespace fringe
