#pragma once

#include <array>
#include <cmath>

#include "fringe/triangle.hpp"

namespace fringe::detail {

/// Computes ∫f dA over a triangle by a rule of degree 2. Divides the triangle by halving its sides until this
/// changes the result by no more than `tolerance`.
template <class Function>
double adaptive_integral(const Triangle& triangle, const Function& function, double tolerance) {
  // Limit of halvings of a side, reached near contact: 4^7 parts.
  constexpr int most_levels = 7;
  const auto rule = [&](const Triangle& part) {
    const auto& [a, b, c] = part;
    return twice_area(part) / 6 *
           (function((4 * a + b + c) / 6) + function((a + 4 * b + c) / 6) + function((a + b + 4 * c) / 6));
  };
  const auto refined = [&](const auto& self, const Triangle& part, double whole, double allowed,
                           int level) -> double {
    const auto& [a, b, c] = part;
    const Eigen::Vector3d ab = (a + b) / 2, bc = (b + c) / 2, ca = (c + a) / 2;
    const std::array<Triangle, 4> parts{Triangle{a, ab, ca}, Triangle{ab, b, bc}, Triangle{ca, bc, c},
                                        Triangle{bc, ca, ab}};
    std::array<double, 4> values;
    double sum = 0;
    for (std::size_t i = 0; i < parts.size(); ++i)
      sum += values[i] = rule(parts[i]);
    if (level == most_levels || (level > 1 && std::abs(sum - whole) <= allowed))
      return sum;
    sum = 0;
    for (std::size_t i = 0; i < parts.size(); ++i)
      sum += self(self, parts[i], values[i], allowed / 2, level + 1);
    return sum;
  };
  return refined(refined, triangle, rule(triangle), tolerance, 0);
}

}  // namespace fringe::detail
