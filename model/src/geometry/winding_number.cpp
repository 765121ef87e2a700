#include "geometry/winding_number.hpp"

#include <cmath>
#include <numbers>

#include <Eigen/Geometry>

namespace fringe::detail {

using Eigen::Vector3d;

bool is_in_polyhedron(std::span<const Triangle> surface, const Vector3d& point) {
  // Half of the triangles' solid angles (A. Van Oosterom and J. Strackee, IEEE Transactions on Biomedical
  // Engineering 30, 1983, 125) add up to 2π times the winding number.
  double sum = 0;
  for (const Triangle& triangle : surface) {
    const Vector3d a = (triangle[0] - point).normalized(), b = (triangle[1] - point).normalized(),
                   c = (triangle[2] - point).normalized();
    sum += std::atan2(a.dot(b.cross(c)), 1 + a.dot(b) + b.dot(c) + c.dot(a));
  }
  return std::abs(sum) > std::numbers::pi;
}

}  // namespace fringe::detail
