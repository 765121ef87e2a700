#include "integral/derivative/choices.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "integral/batch/choices.hpp"
#include "numeric/triangle_rules.hpp"

namespace fringe::detail {
namespace {

/// Relative error of the derivatives that the quadrature rules may leave.
constexpr double tolerance = 1e-8;

/// Computes the largest ratio q of size to distance, or slightly less, for which a rule keeps the error
/// 1.5·c·(degree + 1)·q^degree/(1 − q)² below the tolerance.
double largest_ratio(const TriangleRule& rule) {
  const double scale = tolerance / (1.5 * rule.bound_constant * (rule.degree + 1));
  double q = std::min(0.5, std::pow(scale, 1.0 / rule.degree));
  while (std::pow(q, rule.degree) > scale * (1 - q) * (1 - q))
    q *= 0.999;
  return q;
}

}  // namespace

const Choices& derivative_choices() {
  static const std::vector<RuleChoice> rules = [] {
    std::vector<RuleChoice> made;
    for (const TriangleRule& rule : triangle_rules()) {
      const double ratio = largest_ratio(rule);
      made.push_back({ratio * ratio, rule.nodes, rule.points});
    }
    return made;
  }();
  // A derivative of the integrand along the height adds a factor of about the number of points.
  static const PreparedChoices along_height(tolerance / 10);
  static const Choices choices{rules, along_height.choices().height_rules};
  return choices;
}

}  // namespace fringe::detail
