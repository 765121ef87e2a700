#pragma once

#include <vector>

#include "integral/batch/kernels.hpp"
#include "integral/gauss.hpp"

namespace fringe::detail {

/// The rules among which a batch chooses, prepared for one tolerance.
class PreparedChoices {
 public:
  /// @param tolerance largest relative error of each integral, beside rounding; 0: full precision
  explicit PreparedChoices(double tolerance);

  Choices choices() const { return {rules_, height_rules_}; }

 private:
  std::vector<RuleChoice> rules_;
  std::vector<HeightRuleChoice> height_rules_;
};

/// The choices for a tolerance; those for full precision are made once.
const PreparedChoices& full_precision_choices();

/// Relative error of an integral that counts as full precision: with rounding it stays below 16·1.2e-16, and
/// the bound itself is 10 to 1000 times larger than the error.
constexpr double full_precision = 1e-15;

}  // namespace fringe::detail
