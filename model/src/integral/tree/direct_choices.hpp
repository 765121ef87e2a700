#pragma once

#include "integral/batch/choices.hpp"

namespace fringe::detail {

/// Quadrature rules for integrating triangles one by one, with a bound of the relative error of each
/// integral, rounding not included.
struct DirectChoices {
  double relative_error;
  PreparedChoices choices;
};

/// Returns the cheapest prepared rules for which the bound of a sum, see `bound_of_sum`, is at most the
/// tolerance times the true sum.
const DirectChoices& direct_choices(double tolerance);

/// Bounds the error of a computed sum of integrals. The rules' error is relative to the true integrals.
inline double bound_of_sum(double sum, double relative_error) {
  return sum * relative_error / (1 - relative_error);
}

}  // namespace fringe::detail
