#pragma once

#include <array>
#include <cstddef>

#include "numeric/double_double.hpp"

/// The cone of a distance sensor, and the thesis' two methods to find which points of a line lie in it when
/// its apex is at the origin.
namespace fringe::detail {

/// The cone of a distance sensor with its half angle enlarged by `boundary_width`; all decisions use this
/// one.
struct PreciseCone {
  PreciseVector axis;   ///< of length 1
  DoubleDouble cosine;  ///< of the half angle; negative if the half angle was enlarged beyond 90°
  DoubleDouble sine;
};

/// Angle in radians by which the half angle is enlarged, so that a point counts as inside if only rounding
/// puts it outside. Directions, angles, and vertices as large as their distance each have errors of about
/// 2^−53.
inline constexpr double boundary_width = 0x1p-50;

/// Relative rounding error of a double-double after some dozen operations, with room to spare.
inline constexpr double precise_noise = 0x1p-90;

/// Computes the cone for a finite direction that is not zero.
PreciseCone precise_cone(const Eigen::Vector3d& direction, double full_angle);

/// The points distance·to_foot + u·along, for all u. Both directions have length 1 and are perpendicular, so
/// u = 0 is the point nearest to the origin.
struct PreciseLine {
  DoubleDouble distance;
  PreciseVector to_foot;
  PreciseVector along;

  PreciseVector point(DoubleDouble u) const { return distance * to_foot + u * along; }
};

/// The crossings of a line with a cone's surface: none, one or two values of u.
struct Crossings {
  std::array<DoubleDouble, 2> positions{};
  std::size_t count = 0;

  void add(DoubleDouble position) { positions[count++] = position; }
  const DoubleDouble* begin() const { return positions.data(); }
  const DoubleDouble* end() const { return positions.data() + count; }
};

/// Decides by the angle to the axis, in the frame in which the triangles are given (thesis 4.2.2).
class FieldOfView {
 public:
  explicit FieldOfView(const PreciseCone& cone) : cone_(cone) {}

  static const PreciseVector& to_frame(const PreciseVector& vector) { return vector; }
  static const PreciseVector& from_frame(const PreciseVector& vector) { return vector; }
  const PreciseVector& axis() const { return cone_.axis; }

  bool contains(const PreciseVector& point) const;
  Crossings crossings(const PreciseLine& line) const;

 private:
  PreciseCone cone_;
};

/// Decides by the equation cos²·(x² + y²) = sin²·z², in the frame whose z axis is the cone's (thesis 4.2.1,
/// multiplied out since the tangent may be infinite).
class ConeEquation {
 public:
  explicit ConeEquation(const PreciseCone& cone);

  PreciseVector to_frame(const PreciseVector& vector) const {
    return {dot(x_, vector), dot(y_, vector), dot(z_, vector)};
  }
  PreciseVector from_frame(const PreciseVector& vector) const {
    return vector.x * x_ + vector.y * y_ + vector.z * z_;
  }
  const PreciseVector& axis() const { return axis_; }

  bool contains(const PreciseVector& point) const;
  Crossings crossings(const PreciseLine& line) const;

 private:
  /// Tests whether a crossing lies on the mirror cone, which the squared equation includes, too.
  bool on_mirror_cone(const PreciseLine& line, DoubleDouble position_over_distance) const;

  PreciseVector x_, y_, z_;
  PreciseVector axis_{{}, {}, {1, 0}};
  DoubleDouble cosine_squared_, sine_squared_;
  double cosine_sign_;
};

}  // namespace fringe::detail
