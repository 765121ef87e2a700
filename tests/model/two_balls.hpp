#pragma once

#include <array>

namespace fringe::test {

/// Returns the charges of two balls in free space over 4πε, in m: of the first one, at unit potential, and of
/// the second, grounded; by image charges (W. Thomson, 1853). They must not touch.
/// @param distance of the centres
inline std::array<double, 2> two_balls(double first_radius, double second_radius, double distance) {
  double charge = first_radius, offset = 0;
  std::array<double, 2> sums{charge, 0};
  for (int k = 0; k < 200; ++k) {
    const double from_second = distance - offset;
    const double in_second = -charge * second_radius / from_second;
    const double from_first = distance - second_radius * second_radius / from_second;
    charge = -in_second * first_radius / from_first;
    offset = first_radius * first_radius / from_first;
    sums[0] += charge;
    sums[1] += in_second;
  }
  return sums;
}

}  // namespace fringe::test
