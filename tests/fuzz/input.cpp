#include "input.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

namespace fringe::fuzz {

std::uint8_t Input::byte() {
  if (bytes_.empty())
    return 0;
  const std::uint8_t first = bytes_.front();
  bytes_ = bytes_.subspan(1);
  return first;
}

double Input::number() {
  if (!begun_) {
    begun_ = true;
    const std::uint8_t kind = byte();
    any_bits_ = kind % 4 == 0;
    // The scale is mostly 1, otherwise between the smallest and the largest numbers.
    beside_ = kind / 4 % 2 == 1;
    exponent_ = kind % 4 == 1 ? 8 * static_cast<std::int8_t>(byte()) : 0;
  }
  if (any_bits_) {
    std::uint64_t bits = 0;
    for (int i = 0; i < 8; ++i)
      bits = bits << 8U | byte();
    return std::bit_cast<double>(bits);
  }
  const double sixteenths = static_cast<std::int8_t>(byte());
  double value = std::ldexp(sixteenths, exponent_ - 4);
  if (beside_)
    for (int units = static_cast<std::int8_t>(byte()) % 4; units != 0; units -= units > 0 ? 1 : -1)
      value = std::nextafter(value, units > 0 ? HUGE_VAL : -HUGE_VAL);
  return value;
}

Eigen::Vector3d Input::point() {
  const double x = number(), y = number(), z = number();
  return {x, y, z};
}

bool in_a_scene(const std::vector<Eigen::Vector3d>& points) {
  constexpr double most = 1e30;
  return std::all_of(points.begin(), points.end(),
                     [](const Eigen::Vector3d& point) { return point.cwiseAbs().maxCoeff() <= most; });
}

bool ordinary(const std::vector<Eigen::Vector3d>& points) {
  constexpr double least = 1e-60, most = 1e60;
  for (const Eigen::Vector3d& point : points)
    for (const double value : point)
      if (!(value == 0 || (std::abs(value) >= least && std::abs(value) <= most)))
        return false;
  return true;
}

}  // namespace fringe::fuzz
