#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <random>

#include <Eigen/Geometry>

namespace fringe::benchmarks {

/// Random numbers that are the same with every standard library.
class Random {
 public:
  double uniform(double low, double high) {
    return low + static_cast<double>(engine_() >> 11U) * 0x1p-53 * (high - low);
  }

  std::size_t below(std::size_t limit) { return static_cast<std::size_t>(engine_() % limit); }

  Eigen::Vector3d direction() {
    const double z = uniform(-1, 1), angle = uniform(0, 2 * std::numbers::pi);
    const double across = std::sqrt(1 - z * z);
    return {across * std::cos(angle), across * std::sin(angle), z};
  }

  Eigen::Vector3d in_cube(double half) {
    const double x = uniform(-half, half), y = uniform(-half, half);
    return {x, y, uniform(-half, half)};
  }

  Eigen::Isometry3d turn() {
    const double angle = uniform(0, 2 * std::numbers::pi);
    return Eigen::Isometry3d(Eigen::AngleAxisd(angle, direction()));
  }

 private:
  std::mt19937_64 engine_{1};
};

}  // namespace fringe::benchmarks
