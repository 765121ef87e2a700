#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <random>

#include <Eigen/Geometry>

namespace fringe::benchmarks {

/// Random numbers that are the same with every standard library: the standard specifies the engine
/// completely, but not the distributions.
class Random {
 public:
  explicit Random(std::uint64_t seed = 1) : engine_(seed) {}

  double uniform(double low, double high) {
    return low + static_cast<double>(engine_() >> 11U) * 0x1p-53 * (high - low);
  }

  std::size_t below(std::size_t limit) { return static_cast<std::size_t>(engine_() % limit); }

  /// Returns a uniformly distributed direction: on a sphere the height is uniform (Archimedes).
  Eigen::Vector3d direction() {
    const double z = uniform(-1, 1), angle = uniform(0, 2 * std::numbers::pi);
    const double across = std::sqrt(1 - z * z);
    return {across * std::cos(angle), across * std::sin(angle), z};
  }

  Eigen::Vector3d in_box(const Eigen::AlignedBox3d& box) {
    const double x = uniform(box.min().x(), box.max().x()), y = uniform(box.min().y(), box.max().y());
    return {x, y, uniform(box.min().z(), box.max().z())};
  }

  Eigen::Vector3d in_cube(double half) {
    return in_box({Eigen::Vector3d::Constant(-half), Eigen::Vector3d::Constant(half)});
  }

  Eigen::Isometry3d turn() {
    const double angle = uniform(0, 2 * std::numbers::pi);
    return Eigen::Isometry3d(Eigen::AngleAxisd(angle, direction()));
  }

 private:
  std::mt19937_64 engine_;
};

}  // namespace fringe::benchmarks
