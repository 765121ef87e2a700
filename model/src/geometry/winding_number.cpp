#include "geometry/winding_number.hpp"

#include <cmath>
#include <complex>
#include <numbers>

#include <Eigen/Geometry>

namespace fringe::detail {

using Eigen::Vector3d;

bool is_in_polyhedron(std::span<const Triangle> surface, const Vector3d& point) {
  // Half of the triangles' solid angles (A. Van Oosterom and J. Strackee, IEEE Transactions on Biomedical
  // Engineering 30, 1983, 125) add up to 2π times the winding number. Each is the argument of a complex
  // number; that of their product is the sum without whole turns, which are counted.
  std::complex<double> product = 1;
  int turns = 0;
  for (const Triangle& triangle : surface) {
    const Vector3d a = triangle[0] - point, b = triangle[1] - point, c = triangle[2] - point;
    const double to_a = a.norm(), to_b = b.norm(), to_c = c.norm();
    const std::complex<double> factor(
        to_a * to_b * to_c + a.dot(b) * to_c + b.dot(c) * to_a + c.dot(a) * to_b, a.dot(b.cross(c)));
    const double squared = std::norm(factor);
    // A triangle has no solid angle from a point on its edge; it counts nothing.
    if (squared == 0)
      continue;
    const bool was_above = product.imag() >= 0, is_above = factor.imag() >= 0;
    product *= factor / std::sqrt(squared);
    if (was_above == is_above && was_above != (product.imag() >= 0))
      turns += was_above ? 1 : -1;
  }
  return std::abs(2 * std::numbers::pi * turns + std::arg(product)) > std::numbers::pi;
}

}  // namespace fringe::detail
