#pragma once

#include <cstddef>
#include <vector>

#include "numeric/double_double.hpp"

/// Quadrature rules on [0, 1] for functions that are nearly singular at 0.
namespace fringe::stress {

using detail::DoubleDouble;

/// Nodes and weights, high and low parts apart so that loops over them vectorise.
struct Rule {
  std::vector<double> position_high, position_low;
  std::vector<double> weight_high, weight_low;

  std::size_t size() const { return position_high.size(); }
  DoubleDouble position(std::size_t i) const { return {position_high[i], position_low[i]}; }
  DoubleDouble weight(std::size_t i) const { return {weight_high[i], weight_low[i]}; }
};

/// Gauss rules for functions that are analytic but for singularities at complex points of modulus `closeness`
/// or more and real part ≤ 0: the inverse distance along a segment that leads away from the plate has its
/// singularities there, closeness being the distance at the near end over the length.
///
/// From a closeness of 1 on one rule on [0, 1] does. Below, s = sinh(τ)/sinh(T) with sinh(T) = 1/closeness
/// takes the singularities to where sinh τ has modulus 1, at least 0.88 from the real axis' part τ ≥ 0, and
/// panels of length 2 in τ are integrated.
class GradedRules {
 public:
  /// Rules that leave a relative error of about 10^−digits.
  explicit GradedRules(double digits);

  /// The rule for singularities as close as this or farther.
  const Rule& rule(double closeness) const;

 private:
  std::vector<Rule> plain_;   ///< for closeness 2^i and more
  std::vector<Rule> graded_;  ///< of i + 1 panels
};

}  // namespace fringe::stress
