#include "integral/batch/choices.hpp"

#include <algorithm>
#include <cmath>

#include "numeric/quadrature_rules.hpp"

namespace fringe::detail {
namespace {

/// Largest number of points of a Gauss rule along the height.
constexpr int most_height_points = 12;

/// Ratio of size to distance beyond which the bounds of the rules would be of little use.
constexpr double most_ratio = 0.5;

/// Computes the largest ratio q of size to distance, or slightly less, for which a rule keeps the relative
/// error √(1 + q²)·c·q^(degree + 1)/(1 − q) (model/NUMERICS.md, section 12) below the tolerance.
double largest_ratio(const TriangleRule& rule, double tolerance) {
  const double exponent = 1.0 / (rule.degree + 1), scale = tolerance / rule.bound_constant;
  // Fixed-point iteration whose steps shrink by the factor q/(degree + 1). The loop afterwards reduces q
  // until the bound holds.
  double q = std::min(most_ratio, std::pow(scale, exponent));
  for (int step = 0; step < 4; ++step)
    q = std::min(most_ratio, std::pow(scale * (1 - q) / std::sqrt(1 + q * q), exponent));
  while (std::sqrt(1 + q * q) * rule.bound_constant * std::pow(q, rule.degree + 1) > tolerance * (1 - q))
    q *= 0.999;
  return q;
}

/// Relative error of the derivatives that the quadrature rules may leave.
constexpr double derivative_tolerance = 1e-8;

/// Computes the largest ratio q of size to distance, or slightly less, for which a rule keeps the error of
/// derivatives 1.5·c·(degree + 1)·q^degree/(1 − q)² below their tolerance.
double largest_ratio_for_derivatives(const TriangleRule& rule) {
  const double scale = derivative_tolerance / (1.5 * rule.bound_constant * (rule.degree + 1));
  double q = std::min(most_ratio, std::pow(scale, 1.0 / rule.degree));
  while (std::pow(q, rule.degree) > scale * (1 - q) * (1 - q))
    q *= 0.999;
  return q;
}

/// Returns the rules on triangles, each with its largest ratio of size to distance.
template <class LargestRatio>
std::vector<RuleChoice> rule_choices(const LargestRatio& largest_ratio) {
  std::vector<RuleChoice> made;
  for (const TriangleRule& rule : triangle_rules()) {
    const double ratio = largest_ratio(rule);
    made.push_back({ratio * ratio, rule.nodes, rule.points});
  }
  return made;
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
  rules_ = rule_choices([&](const TriangleRule& rule) { return largest_ratio(rule, asked); });
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

const Choices& derivative_choices() {
  static const std::vector<RuleChoice> rules = rule_choices(largest_ratio_for_derivatives);
  // A derivative of the integrand along the height adds a factor of about the number of points.
  static const PreparedChoices along_height(derivative_tolerance / 10);
  static const Choices choices{rules, along_height.choices().height_rules};
  return choices;
}

const SumChoices& sum_choices(double tolerance) {
  // One tolerance per decade. Preparing takes longer than integrating, so it is done once; between two
  // decades the number of points hardly changes.
  static const std::vector<SumChoices> ladder = [] {
    std::vector<SumChoices> made;
    for (const double step : {1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10, 1e-11, 1e-12})
      made.push_back({0.97 * step, PreparedChoices(0.97 * step)});
    made.push_back({0, PreparedChoices(0)});
    return made;
  }();
  std::size_t step = 0;
  while (bound_of_sum(1 + ladder[step].relative_error, ladder[step].relative_error) > tolerance)
    ++step;
  return ladder[step];
}

}  // namespace fringe::detail
