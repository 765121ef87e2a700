#include "thesis_formula.hpp"

#include <cmath>

#include <Eigen/Geometry>

namespace fringe::stress {

double thesis_formula(const Triangle& triangle, const Rectangle& plate) {
  const Eigen::Vector3d n = plate.edge_u.cross(plate.edge_v).normalized();
  const Eigen::Vector3d u = triangle[1] - triangle[0], v = triangle[2] - triangle[0];
  const double a = u.dot(n), b = v.dot(n), c = triangle[0].dot(n) - plate.corner.dot(n);
  return u.cross(v).norm() / b *
         (b * (a + c) / (a * (a - b)) * std::log(a + c) - (b + c) / (a - b) * std::log(b + c) +
          c / a * std::log(c));
}

}  // namespace fringe::stress
