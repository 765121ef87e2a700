#pragma once

#include <Eigen/Core>

#include <boost/multiprecision/cpp_bin_float.hpp>
#include <boost/multiprecision/eigen.hpp>

namespace fringe::test {

/// A number of 100 digits: squares and products of distances of 1e-15 still have thirty.
using Real =
    boost::multiprecision::number<boost::multiprecision::cpp_bin_float<100>, boost::multiprecision::et_off>;

using RealVector = Eigen::Matrix<Real, 3, 1>;

}  // namespace fringe::test
