#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <boost/multiprecision/eigen.hpp>
#include <boost/multiprecision/mpfr.hpp>

#include "fringe/rectangle.hpp"
#include "fringe/triangle.hpp"
#include "numeric/double_double.hpp"

/// The true integral over a triangle: the triangle is dissected into sectors (sectors.cpp), which quadrature
/// rules that are graded towards the plate integrate (graded_rule.cpp, truth.cpp).
namespace fringe::stress {

using detail::DoubleDouble;

/// A number of 50 digits, stored on the stack, for computations that are done once per triangle. For the
/// thinnest slivers cancellation leaves 1e-20 of the squares involved, and thus still 30 digits.
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

/// A plate's own coordinate system: the origin at its corner, x along edge_u, z along the normal, y = z × x.
struct ExactFrame {
  RealVector corner;
  std::array<RealVector, 3> axes;
  std::array<Real, 2> lengths;
};

ExactFrame exact_frame(const Rectangle& plate);

/// A point of the triangle. Within a sector all three vectors are affine functions of the point.
struct Point {
  RealVector position;     ///< in the plate's coordinates
  RealVector barycentric;  ///< in the whole triangle
  RealVector from_plate;   ///< to it from the nearest point of the plate
};

Point between(const Point& a, const Point& b, const Real& share);

/// A triangle within one of the nine cells. `apex` is the point nearest to the plate of the part of the
/// dissected triangle in that cell; along the edge from `start` to `end` the distance increases.
struct Sector {
  Point apex, start, end;
};

/// A triangle divided into sectors.
struct Dissection {
  ExactFrame frame;
  std::array<RealVector, 3> vertices;  ///< in the plate's coordinates
  Real twice_area;
  bool divergent = false;  ///< the triangle meets the plate along a segment
  std::vector<Sector> sectors;
};

/// Cuts a triangle at the plate's border planes and divides the pieces into sectors.
Dissection dissect(const Triangle& triangle, const Rectangle& plate);

Real twice_area(const RealVector& a, const RealVector& b, const RealVector& c);

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
/// A single Gauss rule on [0, 1] suffices for a closeness of 1 or more. For less, the substitution s =
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
