#include "integral/batch/choices.hpp"

#include <algorithm>
#include <cmath>

#include "numeric/triangle_rules.hpp"

namespace fringe::detail {
namespace {

/// Largest number of points of a Gauss rule along the height.
constexpr int most_height_points = 12;

/// Computes the largest ratio q of size to distance, or slightly less, for which a rule keeps the relative
/// error √(1 + q²)·c·q^(degree + 1)/(1 − q) (model/NUMERICS.md, section 12) below the tolerance.
double largest_ratio(const TriangleRule& rule, double tolerance) {
  // Beyond this ratio the bound would be of little use.
  constexpr double most = 0.5;
  const double exponent = 1.0 / (rule.degree + 1), scale = tolerance / rule.bound_constant;
  // Fixed-point iteration whose steps shrink by the factor q/(degree + 1). The loop afterwards reduces q
  // until the bound holds.
  double q = std::min(most, std::pow(scale, exponent));
  for (int step = 0; step < 4; ++step)
    q = std::min(most, std::pow(scale * (1 - q) / std::sqrt(1 + q * q), exponent));
  while (std::sqrt(1 + q * q) * rule.bound_constant * std::pow(q, rule.degree + 1) > tolerance * (1 - q))
    q *= 0.999;
  return q;
}

/// Returns the Gauss rules of 1 to most_height_points points.
const std::vector<GaussRule>& height_nodes() {
  static const std::vector<GaussRule> rules = [] {
    std::vector<GaussRule> made;
    for (int points = 1; points <= most_height_points; ++points)
      made.push_back(gauss_rule(points));
    return made;
  }();
  return rules;
}

/// Computes the smallest ratio of distance to height, or slightly more, for which the given number of Gauss
/// points keeps the relative error below the tolerance, for a triangle that is at most most_lengths distances
/// long: 128·R^(−2n)/(1 − R⁻²) with asinh(2·0.9·ratio) = ln R (model/NUMERICS.md, section 12).
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
