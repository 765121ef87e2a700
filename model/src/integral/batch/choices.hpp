#pragma once

#include <vector>

#include "integral/batch/kernels.hpp"
#include "numeric/gauss_rule.hpp"

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

}  // namespace fringe::detail
