#pragma once

#include <array>
#include <cstdint>
#include <random>
#include <vector>

#include <Eigen/Geometry>

#include "fringe/gjk.hpp"
#include "fringe/plate_integral.hpp"

/// Helpers with which the tests build triangles and random inputs.
namespace fringe::test {

/// Returns the two triangles of the parallelogram corner + a·u + b·v, 0 ≤ a, b ≤ 1.
inline std::vector<Triangle> parallelogram(const Eigen::Vector3d& corner, const Eigen::Vector3d& u,
                                           const Eigen::Vector3d& v) {
  return {{corner, corner + u, corner + u + v}, {corner, corner + u + v, corner + v}};
}

/// Returns the triangles in another place.
inline std::vector<Triangle> moved(std::vector<Triangle> triangles, const Eigen::Isometry3d& motion) {
  for (Triangle& triangle : triangles)
    for (Eigen::Vector3d& corner : triangle)
      corner = motion * corner;
  return triangles;
}

/// Returns the motion by an amount along the axis 0, 1, 2, or about the axis 3, 4, 5 through the point.
inline Eigen::Isometry3d motion_along(int coordinate, double amount, const Eigen::Vector3d& point) {
  const Eigen::Vector3d axis = Eigen::Vector3d::Unit(coordinate % 3);
  if (coordinate < 3)
    return Eigen::Isometry3d(Eigen::Translation3d(amount * axis));
  return Eigen::Translation3d(point) * Eigen::AngleAxisd(amount, axis) * Eigen::Translation3d(-point);
}

inline double distance_between(const Triangle& triangle, const Rectangle& plate) {
  const auto& [corner, u, v] = plate;
  return gjk_distance(triangle,
                      std::array<Eigen::Vector3d, 4>{corner, corner + u, corner + v, corner + u + v})
      .distance;
}

inline double total_integral(const std::vector<Triangle>& triangles, const Rectangle& plate,
                             const Method& method = Exact{}) {
  double sum = 0;
  for (const double value : plate_integrals(triangles, plate, method))
    sum += value;
  return sum;
}

/// Number of random cases in a test: a tenth in builds without optimisation and under sanitizers, where a
/// case takes ten times as long.
constexpr int draws(int optimised) {
#ifdef NDEBUG
  return optimised;
#else
  return optimised / 10;
#endif
}

/// Random numbers that are identical with every standard library: the standard fixes the engine but not the
/// distributions.
class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}

  double uniform(double low, double high) {
    const double share = static_cast<double>(engine_() >> 11U) * 0x1p-53;
    return low + share * (high - low);
  }

  Eigen::Vector3d in_box(const Eigen::Vector3d& low, const Eigen::Vector3d& high) {
    const double x = uniform(low.x(), high.x()), y = uniform(low.y(), high.y());
    return {x, y, uniform(low.z(), high.z())};
  }

  Triangle triangle_in_box(const Eigen::Vector3d& low, const Eigen::Vector3d& high) {
    const Eigen::Vector3d a = in_box(low, high), b = in_box(low, high);
    return {a, b, in_box(low, high)};
  }

  Eigen::Isometry3d rigid_motion() {
    const Eigen::Vector3d axis = in_box({-1, -1, -1}, {1, 1, 1}).normalized();
    Eigen::Isometry3d motion = Eigen::Isometry3d::Identity();
    motion.rotate(Eigen::AngleAxisd(uniform(0, 6), axis));
    motion.pretranslate(in_box({-1, -1, -1}, {1, 1, 1}));
    return motion;
  }

 private:
  std::mt19937_64 engine_;
};

}  // namespace fringe::test
