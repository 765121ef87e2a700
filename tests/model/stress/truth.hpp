#pragma once

#include "numeric/double_double.hpp"
#include "sectors.hpp"

namespace fringe::stress {

using detail::DoubleDouble;

/// What an integral is, as far as quadrature can tell.
struct Truth {
  DoubleDouble value;      ///< 0 without area, +infinity where the integral diverges
  bool converged = false;  ///< two orders of quadrature agree to 1e-19 of the value
};

/// ∫dA/d over a cut-up triangle by quadrature of the distance itself; no antiderivative is used.
///
/// In a sector the point is apex + s·(start + t·(end − start) − apex), s and t in [0, 1]: the area element is
/// s ds dt, which takes away the singularity of an apex on the plate (M. G. Duffy, SIAM Journal on Numerical
/// Analysis 19, 1982). The apex is the point nearest to the plate, so along s the distance only grows, and
/// along t it does by the choice of the start: both integrals are of the kind that GradedRules integrates.
Truth integrate(const Dissection& dissection);

}  // namespace fringe::stress
