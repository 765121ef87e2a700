#pragma once

#include <optional>
#include <vector>

#include <Eigen/Geometry>

#include "collision/convex_pieces.hpp"
#include "fringe/shape.hpp"
#include "surface/panel.hpp"

/// Round shapes, and how far the polyhedra are from them that stand for them (model/BOUNDARY_ELEMENTS.md,
/// section 9).
namespace fringe::detail {

/// Error per effect of the facets in first order, where this is not added to the answer: the next order, and
/// charges that panels do not resolve.
constexpr double error_per_facet_effect = 1.25;

/// The same where the effect is added.
constexpr double error_per_added_facet_effect = 0.2;

/// A round shape in the frame of a body.
class RoundShape {
 public:
  /// Returns nothing for a shape that its triangles have exactly. A thin arc gets the segments that it needs
  /// to be followed.
  static std::optional<RoundShape> of(const Shape& shape, const Eigen::Isometry3d& pose);

  RoundShape moved(const Eigen::Isometry3d& pose) const;
  /// Returns the shape about another origin, in another unit (m).
  RoundShape in_unit(const Eigen::Vector3d& origin, double unit) const;

  /// Returns the same shape for which fewer triangles stand: at most so many, as far as its segments are not
  /// below eight.
  RoundShape with_fewer_triangles(std::size_t most) const;

  /// Returns the triangles that stand for the shape, in the frame of the body.
  std::vector<Triangle> triangles() const;

  /// Returns true if the polyhedron lies within the shape, so that its capacitance is the smaller one.
  bool contains_polyhedron() const { return !std::holds_alternative<Arc>(shape_); }

  bool is_thin() const { return std::holds_alternative<Disc>(shape_); }

  /// Tells whether panels follow the shape when they are divided: their new corners lie on it. An arc stays a
  /// polyhedron if one of its walls, once divided, might cross the other.
  bool is_followed() const;

  /// Tells whether what the facets lack is added to the answer: not where round surfaces end at rims with a
  /// singular charge, for which Hadamard's formula is good for an error only.
  bool is_lack_added() const;

  /// Returns the error per effect of the facets in first order, whether this is added or not.
  double error_per_lack() const {
    return is_lack_added() ? error_per_added_facet_effect : error_per_facet_effect;
  }

  /// Returns the point of a followed shape's surface that is near a point of its polyhedron.
  Eigen::Vector3d on_shape(const Eigen::Vector3d& point) const;

  /// Returns the same near the middle of a side of a panel. On a disc only sides along the rim move.
  Eigen::Vector3d middle(const Eigen::Vector3d& from, const Eigen::Vector3d& to) const;

  /// Returns the shape's convex pieces, and a box around it, in the frame of the body, which has to be in m.
  std::vector<ConvexPiece> pieces() const;
  Eigen::AlignedBox3d box() const;

  /// Returns the greatest distance from the middles of parts of the polyhedron's surface, and of their sides,
  /// to the shape's surface, along the parts' normals.
  double greatest_depth(std::span<const Triangle> parts) const;

  /// Returns the mean distance from a part of the polyhedron's surface to the shape's surface, along the
  /// part's normal.
  double depth(const Triangle& part) const;

  /// Returns what a conductor's capacitance lacks (over 4πε, m) per square of the charge on a panel: by
  /// Hadamard's formula for a surface that moves by depth(), or for the rim of a disc that moves in its
  /// plane.
  double lack_per_squared_charge(const Panel& panel) const;

  /// Returns the same for the area that a flat panel lacks along the rim of a round surface, where
  /// lack_per_squared_charge() finds too little: before a narrow gap, or where the rim is sharp, the wall's
  /// charge is next to the rim, and panels average it. Only an error follows from it.
  ///
  /// @param largest_charge the panel's largest one, for unit potentials
  double lack_along_rim(const Panel& panel, double largest_charge) const;

 private:
  RoundShape(Shape shape, const Eigen::Isometry3d& pose)
      : shape_(std::move(shape)), to_shape_(pose.inverse()) {}

  Shape shape_;
  Eigen::Affine3d to_shape_;  ///< from the frame of the body
  double unit_ = 1;           ///< m per unit of length of the body's frame
};

}  // namespace fringe::detail
