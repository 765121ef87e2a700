#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <string_view>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "fringe/triangle.hpp"

/// The distance sensor of the thesis, chapter 4: finds the closest point that lies in a cone
/// (model/NUMERICS.md, section 14). Lengths are in the unit of the triangles.
namespace fringe {

/// The view of a distance sensor: the points within full_angle/2 of a direction, up to the range. The end is
/// a spherical cap, so the sensor sees equally far in every direction. The boundary counts as inside, and so
/// do points that only rounding puts outside: the half angle is enlarged by 2⁻⁵⁰ radians, the range by a
/// factor of 1 + 2⁻⁵⁰.
struct SensingCone {
  Eigen::Vector3d apex;
  Eigen::Vector3d direction;  ///< of any nonzero length
  double full_angle;          ///< radians, in (0, π]
  double range;               ///< > 0
};

/// The method that decides which points of a line lie in the cone.
enum class ConeMethod {
  field_of_view,  ///< by the angle between the direction and the line of sight (thesis 4.2.2)
  cone_equation   ///< by the equation of the cone in its own frame (thesis 4.2.1)
};

/// Reads "field_of_view" or "cone_equation"; throws InputError for anything else.
ConeMethod parse_cone_method(std::string_view text);

/// A point that a distance sensor detects.
struct VisiblePoint {
  double distance;        ///< from the apex
  Eigen::Vector3d point;  ///< in the cone's frame of reference
  std::size_t triangle;   ///< index of the triangle on which it lies
};

/// Throws InputError unless everything is finite, the direction is not zero, and the angle and the range are
/// as SensingCone states.
void validate(const SensingCone& cone);

/// Finds the point of the triangles nearest to the apex among those in the cone; returns nothing if no point
/// is in it. Nothing can hide this point, since whatever is in front of it would be nearer and in the cone,
/// too. Among equally near points the one on the triangle with the lowest index is returned.
///
/// The distance is accurate to a relative error of 1e-15, and the point to the same plus the rounding of its
/// coordinates, for triangles of any shape (including segments and points), size and place. If the apex is on
/// a triangle up to the rounding of the coordinates, 2⁻⁵¹ of each, the distance is 0. Throws InputError as
/// validate(cone) does, and for a vertex that is not finite.
std::optional<VisiblePoint> cone_closest(std::span<const Triangle> triangles, const SensingCone& cone,
                                         ConeMethod method = ConeMethod::field_of_view);

namespace detail {
class TriangleTree;
}

/// A surface of many triangles, prepared once for cones anywhere: a query visits only triangles near the
/// answer. The answers are those of cone_closest, to the last bit.
class SensedSurface {
 public:
  /// Builds the bounding volume hierarchy. Throws InputError for a vertex that is not finite.
  explicit SensedSurface(std::span<const Triangle> triangles);
  ~SensedSurface();
  SensedSurface(SensedSurface&&) noexcept;
  SensedSurface& operator=(SensedSurface&&) noexcept;
  SensedSurface(const SensedSurface&) = delete;
  SensedSurface& operator=(const SensedSurface&) = delete;

  /// Returns what cone_closest finds on transformed(triangle, pose) of every triangle, for a cone given in
  /// the frame to which the pose leads. Throws InputError as validate(cone) does.
  std::optional<VisiblePoint> closest(const SensingCone& cone, ConeMethod method = ConeMethod::field_of_view,
                                      const Eigen::Isometry3d& pose = Eigen::Isometry3d::Identity()) const;

 private:
  std::unique_ptr<const detail::TriangleTree> tree_;
};

}  // namespace fringe
