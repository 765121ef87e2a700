#pragma once

#include <cmath>

#include <Eigen/Core>

/// Differences of products without cancellation. Every fused multiply-add is written out: the compiler must
/// not contract expressions on its own.
namespace fringe::detail {

/// Computes a·b − c·d with an error of at most 1.5 units in the last place (Kahan's algorithm; Jeannerod,
/// Louvet and Muller, Mathematics of Computation 82, 2013).
inline double difference_of_products(double a, double b, double c, double d) {
  const double product = c * d;
  const double rounding = std::fma(-c, d, product);
  return std::fma(a, b, -product) + rounding;
}

/// Computes a × b, each component to 1.5 units in its last place, also for nearly parallel vectors of any
/// lengths.
inline Eigen::Vector3d cross(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return {difference_of_products(a.y(), b.z(), a.z(), b.y()),
          difference_of_products(a.z(), b.x(), a.x(), b.z()),
          difference_of_products(a.x(), b.y(), a.y(), b.x())};
}

}  // namespace fringe::detail
