#pragma once

#include <vector>

#include "integral/batch/kernels.hpp"
#include "numeric/quadrature_rules.hpp"

namespace fringe::detail {

/// The quadrature rules from which a batch chooses, prepared for one tolerance.
class PreparedChoices {
 public:
  /// @param tolerance largest relative error of each integral, rounding not included; 0: full precision
  explicit PreparedChoices(double tolerance);

  Choices choices() const { return {rules_, height_rules_}; }

 private:
  std::vector<RuleChoice> rules_;
  std::vector<HeightRuleChoice> height_rules_;
};

/// Returns the choices for full precision, which are made once.
const PreparedChoices& full_precision_choices();

/// Bound of the relative error of an integral that counts as full precision. The actual error is 10 to 1000
/// times smaller, and below 16·1.2e-16 with rounding.
constexpr double full_precision = 1e-15;

/// Returns the rules from which the derivatives of ∫dA/d choose, with the ratios for which the error relative
/// to ∫dA/d² over the triangle is at most 1e-8 (model/NUMERICS.md, section 15).
const Choices& derivative_choices();

/// Rules for a sum of integrals, with a bound of the relative error of each, rounding not included.
struct SumChoices {
  double relative_error;
  PreparedChoices choices;
};

/// Returns the cheapest prepared rules for which the bound of a sum, see `bound_of_sum`, is at most the
/// tolerance times the true sum.
const SumChoices& sum_choices(double tolerance);

/// Bounds the error of a computed sum of integrals. The rules' error is relative to the true integrals.
inline double bound_of_sum(double sum, double relative_error) {
  return sum * relative_error / (1 - relative_error);
}

}  // namespace fringe::detail
