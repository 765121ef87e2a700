#pragma once

#include "integral/batch/kernels.hpp"

namespace fringe::detail {

/// Returns the quadrature rules from which the derivatives of ∫dA/d choose, with the ratios for which the
/// error relative to ∫dA/d² over the triangle is at most 1e-8 (model/NUMERICS.md, section 15).
const Choices& derivative_choices();

}  // namespace fringe::detail
