#include "sensing/precise_cone.hpp"

#include <cmath>

namespace fringe::detail {
namespace {

struct CosineAndSine {
  DoubleDouble cosine, sine;
};

/// Computes both by the Taylor series at an eighth of the angle, whose terms fall below 2^−110 after the
/// twelfth, and by doubling the angle three times. The doubling works on 1 − cosine, so that a cosine near 1
/// keeps its digits.
CosineAndSine cosine_and_sine(DoubleDouble angle) {
  constexpr int halvings = 3, terms = 24;
  const DoubleDouble x = 0x1p-3 * angle, square = x * x;
  DoubleDouble versine{}, sine = x;
  DoubleDouble even = 0.5 * square, odd = x;
  for (int n = 2; n <= terms; n += 2) {
    versine = versine + even;
    odd = -(odd * square) / DoubleDouble{static_cast<double>(n * (n + 1)), 0};
    sine = sine + odd;
    even = -(even * square) / DoubleDouble{static_cast<double>((n + 1) * (n + 2)), 0};
  }
  constexpr DoubleDouble one{1, 0};
  for (int i = 0; i < halvings; ++i) {
    sine = 2.0 * (sine * (one - versine));
    versine = 2.0 * (versine * (DoubleDouble{2, 0} - versine));
  }
  return {one - versine, sine};
}

}  // namespace

PreciseCone precise_cone(const Eigen::Vector3d& direction, double full_angle) {
  const int exponent = std::ilogb(direction.cwiseAbs().maxCoeff());
  const Eigen::Vector3d scaled = direction.unaryExpr([=](double x) { return std::ldexp(x, -exponent); });
  const auto [cosine, sine] = cosine_and_sine(exact_sum(full_angle / 2, boundary_width));
  return {polar(exact_difference(scaled, Eigen::Vector3d::Zero())).direction, cosine, sine};
}

}  // namespace fringe::detail
