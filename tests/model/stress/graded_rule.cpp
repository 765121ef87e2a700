#include "truth.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <utility>

namespace fringe::stress {
namespace {

/// Length of a panel in τ.
constexpr int panel_length = 2;

/// Largest number of panels, with sinh(60) = 6e25. A segment that starts closer than 1e-25 of its length to
/// the plate counts as touching it: s/distance is then constant up to a relative error of that size.
constexpr int most_panels = 30;

/// Exponent of the largest closeness with a rule of its own, 2^24. The few nodes of this rule are accurate to
/// all digits for any larger closeness.
constexpr int most_doublings = 24;

struct RealNode {
  Real position;
  Real weight;
};

/// Computes the Gauss–Legendre rule on [−1, 1] by Newton's method on the Legendre polynomial.
std::vector<RealNode> gauss_legendre(int points) {
  std::vector<RealNode> rule;
  for (int i = 0; i < points; ++i) {
    Real x = std::cos(std::numbers::pi * (i + 0.75) / (points + 0.5));
    Real derivative;
    // The error is below 1e-3 at first and squared in each step: six steps reach 1e-50, and the seventh is a
    // reserve.
    for (int step = 0; step < 7; ++step) {
      Real previous = 1, current = x;
      for (int n = 2; n <= points; ++n) {
        const Real next = ((2 * n - 1) * x * current - (n - 1) * previous) / n;
        previous = std::exchange(current, next);
      }
      derivative = points * (x * current - previous) / (x * x - 1);
      x -= current / derivative;
    }
    rule.push_back({x, 2 / ((1 - x * x) * derivative * derivative)});
  }
  return rule;
}

/// Computes the number of Gauss points on [−1, 1] that give a relative error of 10^−digits for a function
/// with the given singularity. The error of n points is about ρ^(−2n), where ρ is the sum of the semi-axes of
/// the ellipse with foci ±1 through the singularity.
int points_for(double digits, std::complex<double> singularity) {
  const std::complex<double> root = std::sqrt(singularity * singularity - 1.0);
  const double rho = std::max(std::abs(singularity + root), std::abs(singularity - root));
  return 1 + static_cast<int>(std::ceil(digits * std::numbers::ln10 / (2 * std::log(rho))));
}

void append(Rule& rule, const Real& position, const Real& weight) {
  const DoubleDouble p = to_double_double(position), w = to_double_double(weight);
  rule.position_high.push_back(p.high);
  rule.position_low.push_back(p.low);
  rule.weight_high.push_back(w.high);
  rule.weight_low.push_back(w.low);
}

Rule plain_rule(int points) {
  Rule rule;
  for (const auto& [x, weight] : gauss_legendre(points))
    append(rule, (1 + x) / 2, weight / 2);
  return rule;
}

Rule graded_rule(const std::vector<RealNode>& panel, int panels) {
  Rule rule;
  const Real scale = 1 / Real(sinh(Real(panels * panel_length)));
  for (int k = 0; k < panels; ++k)
    for (const auto& [x, weight] : panel) {
      const Real tau = panel_length * (k + (1 + x) / 2);
      append(rule, scale * sinh(tau), scale * cosh(tau) * weight * panel_length / 2);
    }
  return rule;
}

}  // namespace

GradedRules::GradedRules(double digits) {
  for (int i = 0; i <= most_doublings; ++i) {
    const double closeness = std::ldexp(1.0, i);
    // The worst singularity with a real part ≤ 0, ±i·closeness, transformed to [−1, 1].
    plain_.push_back(plain_rule(points_for(digits, {-1, 2 * closeness})));
  }
  // The singularity at sinh τ = −1, relative to the first panel.
  const std::vector<RealNode> panel =
      gauss_legendre(points_for(digits, {-1 - 2 * std::asinh(1.0) / panel_length, 0}));
  for (int panels = 1; panels <= most_panels; ++panels)
    graded_.push_back(graded_rule(panel, panels));
}

const Rule& GradedRules::rule(double closeness) const {
  if (closeness >= 1) {
    const int doublings =
        closeness < std::ldexp(1.0, most_doublings) ? std::ilogb(closeness) : most_doublings;
    return plain_[static_cast<std::size_t>(doublings)];
  }
  const double panels = closeness > 0 ? std::ceil(std::asinh(1 / closeness) / panel_length) : most_panels;
  return graded_[static_cast<std::size_t>(std::clamp(panels, 1.0, static_cast<double>(most_panels))) - 1];
}

}  // namespace fringe::stress
