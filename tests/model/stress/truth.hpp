#pragma once

#include "numeric/double_double.hpp"
#include "sectors.hpp"

namespace fringe::stress {

using detail::DoubleDouble;

/// The true value of an integral, as far as quadrature can determine it.
struct Truth {
  DoubleDouble value;      ///< 0 without area, +infinity where the integral diverges
  bool converged = false;  ///< two orders of quadrature agree to 1e-19 of the value
};

/// Computes ∫dA/d over a dissected triangle by quadrature of the distance itself, without any antiderivative.
///
/// In a sector the point is apex + s·(start + t·(end − start) − apex), with s and t in [0, 1]. The area
/// element is s ds dt, which removes the singularity of an apex on the plate (M. G. Duffy, SIAM Journal on
/// Numerical Analysis 19, 1982). The apex is the point nearest to the plate, so the distance increases along
/// s; along t it increases by the choice of the start. Both integrals therefore meet the assumptions of
/// GradedRules.
Truth integrate(const Dissection& dissection);

/// Computes the largest relative change of ∫dA/d when one of the 18 numbers that describe a triangle and a
/// plate changes by one unit in its last place, to two digits or as an underestimate. No method in double
/// precision can be expected to be more accurate. `value` is the integral, finite and positive.
///
/// Differentiates under the integral sign. Where the triangle is as close to the plate as the units in the
/// last place themselves, distances are taken larger than they are.
double conditioning(const Dissection& dissection, const Triangle& triangle, const Rectangle& plate,
                    double value);

}  // namespace fringe::stress
