#pragma once

#include "fringe/evaluation.hpp"
#include "integral/surface_integral.hpp"

namespace fringe::detail {

/// Returns the options of a triangle-integral method or the formula. Throws InputError for another method,
/// and for options that are out of range or cannot be combined.
IntegralOptions integral_options(const EvaluationOptions& options);

}  // namespace fringe::detail
