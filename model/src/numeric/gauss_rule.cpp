#include "numeric/gauss_rule.hpp"

#include <cmath>
#include <numbers>

namespace fringe::detail {
namespace {

struct LegendreValue {
  long double value;
  long double derivative;
};

/// Evaluates the Legendre polynomial of the given degree and its derivative at x inside (−1, 1).
LegendreValue legendre(int degree, long double x) {
  long double previous = 1, current = x;
  for (int n = 2; n <= degree; ++n) {
    const long double next = ((2 * n - 1) * x * current - (n - 1) * previous) / n;
    previous = current;
    current = next;
  }
  return {current, degree * (x * current - previous) / (x * x - 1)};
}

}  // namespace

GaussRule gauss_rule(int points) {
  GaussRule rule;
  for (int i = 0; i < points; ++i) {
    // Chebyshev's estimate of the root lies where Newton's method converges quadratically: five steps reach
    // the last bit.
    long double x = -std::cos(std::numbers::pi_v<long double> * (i + 0.75L) / (points + 0.5L));
    for (int step = 0; step < 5; ++step) {
      const auto [value, derivative] = legendre(points, x);
      x -= value / derivative;
    }
    const long double derivative = legendre(points, x).derivative;
    rule.push_back(
        {static_cast<double>((1 + x) / 2), static_cast<double>(1 / ((1 - x * x) * derivative * derivative))});
  }
  return rule;
}

}  // namespace fringe::detail
