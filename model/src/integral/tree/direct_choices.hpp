#pragma once

#include "integral/batch/choices.hpp"

namespace fringe::detail {

/// Rules for integrating triangles one by one, with the largest relative error of each integral, beside
/// rounding.
struct DirectChoices {
  double relative_error;
  PreparedChoices choices;
};

/// The coarsest of a ladder of rules with which the bound of a sum, see `bound_of_sum`, is not above the
/// tolerance times the true sum.
const DirectChoices& direct_choices(double tolerance);

/// What a computed sum of integrals is off, at most: the rules' error is relative to the true integrals.
inline double bound_of_sum(double sum, double relative_error) {
  return sum * relative_error / (1 - relative_error);
}

}  // namespace fringe::detail
