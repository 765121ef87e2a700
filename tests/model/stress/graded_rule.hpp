#pragma once

#include <cstddef>
#include <vector>

#include "numeric/double_double.hpp"

/// Quadrature rules on [0, 1] for functions that are nearly singular at 0.
namespace fringe::stress {

using detail::DoubleDouble;

/// Nodes and weights in double-double precision, with separate arrays for high and low parts so that loops
/// vectorise.
struct Rule {
  std::vector<double> position_high, position_low;
  std::vector<double> weight_high, weight_low;

  std::size_t size() const { return position_high.size(); }
  DoubleDouble position(std::size_t i) const { return {position_high[i], position_low[i]}; }
  DoubleDouble weight(std::size_t i) const { return {weight_high[i], weight_low[i]}; }
};

/// Gauss rules for functions that are analytic except for singularities at complex points of modulus
/// `closeness` or more with real part ≤ 0. The inverse distance along a segment that leads away from the
/// plate has such singularities; closeness is the ratio of the distance at the near end to the length.
///
/// From a closeness of 1 on, a single Gauss rule on [0, 1] suffices. Below, the substitution s =
/// sinh(τ)/sinh(T) with sinh(T) = 1/closeness moves the singularities to points where sinh τ has modulus 1,
/// at least 0.88 away from the half axis τ ≥ 0, and panels of length 2 in τ are integrated.
class GradedRules {
 public:
  /// Prepares rules with a relative error of about 10^−digits.
  explicit GradedRules(double digits);

  /// Returns the rule for singularities of this closeness or more.
  const Rule& rule(double closeness) const;

 private:
  std::vector<Rule> plain_;   ///< rule i is for a closeness of 2^i and more
  std::vector<Rule> graded_;  ///< rule i has i + 1 panels
};

}  // namespace fringe::stress
