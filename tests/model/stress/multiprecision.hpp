#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <boost/multiprecision/eigen.hpp>
#include <boost/multiprecision/mpfr.hpp>

#include "numeric/double_double.hpp"

/// Numbers of 50 digits, stored on the stack, for computations that are done once per triangle. For the
/// thinnest slivers cancellation leaves 1e-20 of the squares involved, and thus still 30 digits.
namespace fringe::stress {

using detail::DoubleDouble;

using Real = boost::multiprecision::number<
    boost::multiprecision::mpfr_float_backend<50, boost::multiprecision::allocate_stack>,
    boost::multiprecision::et_off>;

using RealVector = Eigen::Matrix<Real, 3, 1>;

/// Rounds a number to the nearest double-double.
inline DoubleDouble to_double_double(const Real& number) {
  const auto high = static_cast<double>(number);
  return {high, static_cast<double>(Real(number - high))};
}

inline Real to_real(DoubleDouble number) {
  return Real(number.high) + Real(number.low);
}

}  // namespace fringe::stress
