#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <string_view>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "fringe/triangle.hpp"

/// The distance sensor of the thesis, chapter 4: the closest point that lies in a cone (model/NUMERICS.md,
/// section 14). Lengths are in the unit of the triangles.
namespace fringe {

/// What a distance sensor sees: the points within full_angle/2 of a direction, as far as the range. The end
/// is a spherical cap, so the sensor sees equally far in every direction. The boundary counts as inside, and
/// so does what is outside by rounding: half of the angle is taken 2⁻⁵⁰ radians larger, the range by a share
/// of 2⁻⁵⁰.
struct SensingCone {
  Eigen::Vector3d apex;
  Eigen::Vector3d direction;  ///< of any length but zero
  double full_angle;          ///< radians, in (0, π]
  double range;               ///< > 0
};

/// How it is decided which points of a line lie in the cone.
enum class ConeMethod {
  field_of_view,  ///< by the angle between the direction and the line of sight (thesis 4.2.2)
  cone_equation   ///< by the equation of the cone in its own frame (thesis 4.2.1)
};

/// "field_of_view" or "cone_equation"; throws InputError for anything else.
ConeMethod parse_cone_method(std::string_view text);

/// A point that a distance sensor sees.
struct VisiblePoint {
  double distance;        ///< from the apex
  Eigen::Vector3d point;  ///< in the cone's frame of reference
  std::size_t triangle;   ///< the index of the triangle it lies on
};

/// Throws InputError unless everything is finite, the direction is not zero, and the angle and the range are
/// what SensingCone says.
void validate(const SensingCone& cone);

/// The point of the triangles that is nearest to the apex among those in the cone; none when there is none in
/// it. Nothing can hide it, since what is in front of it would be nearer and in the cone, too. Of several the
/// one on the triangle with the lowest index.
///
/// The distance is right to 1e-15 of itself and the point to that and its coordinates' rounding, whatever the
/// triangles' shape (segments and points are triangles, too), size and place. An apex that is on a triangle
/// but for rounding of the coordinates, 2⁻⁵¹ of each, has the distance 0. Throws InputError as validate(cone)
/// does, and for a vertex that is not finite.
std::optional<VisiblePoint> cone_closest(std::span<const Triangle> triangles, const SensingCone& cone,
                                         ConeMethod method = ConeMethod::field_of_view);

namespace detail {
class TriangleTree;
}

/// A surface of many triangles, prepared once for cones anywhere: only triangles near the answer are looked
/// at. The answers are those of cone_closest, to the last bit.
class SensedSurface {
 public:
  /// Throws InputError for a vertex that is not finite.
  explicit SensedSurface(std::span<const Triangle> triangles);
  ~SensedSurface();
  SensedSurface(SensedSurface&&) noexcept;
  SensedSurface& operator=(SensedSurface&&) noexcept;
  SensedSurface(const SensedSurface&) = delete;
  SensedSurface& operator=(const SensedSurface&) = delete;

  /// What cone_closest finds on transformed(triangle, pose) of every triangle, for a cone given in the frame
  /// that the pose leads to. Throws InputError as validate(cone) does.
  std::optional<VisiblePoint> closest(const SensingCone& cone, ConeMethod method = ConeMethod::field_of_view,
                                      const Eigen::Isometry3d& pose = Eigen::Isometry3d::Identity()) const;

 private:
  std::unique_ptr<const detail::TriangleTree> tree_;
};

}  // namespace fringe
