#include "integral/batch/choices.hpp"

#include <algorithm>
#include <cmath>

#include "numeric/triangle_rules.hpp"

namespace fringe::detail {
namespace {

/// The most points of a rule along the height.
constexpr int most_height_points = 12;

/// The largest ratio q of size to distance for which a rule keeps the relative error
/// √(1 + q²)·c·q^(degree + 1)/(1 − q) (model/NUMERICS.md, section 12) below the tolerance, or a little less.
double largest_ratio(const TriangleRule& rule, double tolerance) {
  // Beyond it the bound would be of little use.
  constexpr double most = 0.5;
  const double exponent = 1.0 / (rule.degree + 1), scale = tolerance / rule.bound_constant;
  // A fixed point whose steps shrink by q/(degree + 1); what they have not reached is taken off.
  double q = std::min(most, std::pow(scale, exponent));
  for (int step = 0; step < 4; ++step)
    q = std::min(most, std::pow(scale * (1 - q) / std::sqrt(1 + q * q), exponent));
  while (std::sqrt(1 + q * q) * rule.bound_constant * std::pow(q, rule.degree + 1) > tolerance * (1 - q))
    q *= 0.999;
  return q;
}

/// Gauss rules of 1 to most_height_points points.
const std::vector<GaussRule>& height_nodes() {
  static const std::vector<GaussRule> rules = [] {
    std::vector<GaussRule> made;
    for (int points = 1; points <= most_height_points; ++points)
      made.push_back(gauss_rule(points));
    return made;
  }();
  return rules;
}

/// The smallest ratio of distance to height, or a little more, for which so many Gauss points keep the
/// relative error of a triangle no longer than most_lengths distances below the tolerance:
/// 128·R^(−2n)/(1 − R⁻²) with asinh(2·0.9·ratio) = ln R (model/NUMERICS.md, section 12).
double smallest_ratio(int points, double tolerance) {
  const double exponent = 1.0 / (2.0 * points), scale = 128 / tolerance;
  double growth = std::max(1.0, std::pow(scale, exponent));
  while (scale > std::pow(growth, 2 * points) * (1 - 1 / (growth * growth)))
    growth *= 1.001;
  return std::sinh(std::log(growth)) / 1.8;
}

}  // namespace

PreparedChoices::PreparedChoices(double tolerance) {
  const double asked = std::max(tolerance, full_precision);
  for (const TriangleRule& rule : triangle_rules()) {
    const double ratio = largest_ratio(rule, asked);
    rules_.push_back({ratio * ratio, rule.nodes, rule.points});
  }
  for (int points = 1; points <= most_height_points; ++points) {
    const double ratio = smallest_ratio(points, asked);
    height_rules_.push_back(
        {ratio * ratio, height_nodes()[static_cast<std::size_t>(points) - 1].data(), points});
  }
}

const PreparedChoices& full_precision_choices() {
  static const PreparedChoices choices(0);
  return choices;
}

}  // namespace fringe::detail
