#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include <Eigen/Core>

#include "fringe/rectangle.hpp"
#include "fringe/triangle.hpp"

namespace fringe::detail {

/// A plate's own coordinate system: the origin at its corner, x along edge_u, y along edge_v, z along its
/// normal. In these coordinates the plate is 0 ≤ x ≤ length_u, 0 ≤ y ≤ length_v, z = 0.
struct PlateFrame {
  Eigen::Vector3d corner;
  Eigen::Matrix3d axes;  ///< rows: the unit vectors of x, y, z
  double length_u;
  double length_v;
};

/// The vertices of a triangle in a plate's coordinates.
using LocalTriangle = std::array<Eigen::Vector3d, 3>;

/// Computes the frame of a valid rectangle.
PlateFrame plate_frame(const Rectangle& plate);

LocalTriangle to_local(const PlateFrame& plate, const Triangle& triangle);

/// Computes the distance from a point in the plate's coordinates to the plate.
inline double distance(const PlateFrame& plate, const Eigen::Vector3d& point) {
  const double beside_u = point.x() - std::clamp(point.x(), 0.0, plate.length_u);
  const double beside_v = point.y() - std::clamp(point.y(), 0.0, plate.length_v);
  return std::sqrt(beside_u * beside_u + beside_v * beside_v + point.z() * point.z());
}

}  // namespace fringe::detail
