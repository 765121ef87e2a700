#pragma once

#include <cmath>
#include <limits>

#include <Eigen/Core>

#include "numeric/compensated.hpp"

/// Integrals of 1/distance along a segment as seen from the origin (model/NUMERICS.md, section 3).
namespace fringe::detail {

/// Argument x of atanh_excess below which its power series is used; thirteen terms suffice there.
constexpr double series_limit = 1.0 / 16;

/// Argument x of atanh_excess from which the logarithm is used, because no digits cancel there. Below it, two
/// halvings of the argument lead to the series.
constexpr double logarithm_limit = 0.6;

/// Evaluates b(x) = (atanh(√x)/√x − 1)/x = 1/3 + x/5 + x²/7 + … by its power series, for x below
/// series_limit. The truncation error is below 1e-17.
inline double atanh_excess_series(double x) {
  // Even and odd powers are summed separately: two short dependency chains instead of a long one.
  const double y = x * x;
  const double even =
      1.0 / 3 + y * (1.0 / 7 + y * (1.0 / 11 + y * (1.0 / 15 + y * (1.0 / 19 + y * (1.0 / 23 + y / 27)))));
  const double odd = 1.0 / 5 + y * (1.0 / 9 + y * (1.0 / 13 + y * (1.0 / 17 + y * (1.0 / 21 + y / 25))));
  return even + x * odd;
}

/// Evaluates b(x) for x below logarithm_limit. The identity atanh(w) = 2·atanh(w/(1 + √(1 − w²))) halves the
/// argument until the series applies. Every term is positive, so no digits are lost.
inline double atanh_excess(double x) {
  if (x < series_limit)
    return atanh_excess_series(x);
  const double divisor = 1 + std::sqrt(1 - x);
  const double squared_divisor = divisor * divisor;
  return (1 + 2 * atanh_excess(x / squared_divisor) / divisor) / squared_divisor;
}

/// Evaluates b(x) for x in [logarithm_limit, 1), given atanh(√x).
inline double atanh_excess(double x, double atanh) {
  return (atanh / std::sqrt(x) - 1) / x;
}

/// Computes 1 − |B − A|²/(|A| + |B|)² = 2(|A||B| + A·B)/(|A| + |B|)² without cancellation, also when the
/// segment AB passes close to the origin (A·B near −|A||B|).
inline double one_minus_squared_ratio(const Eigen::Vector3d& a, const Eigen::Vector3d& b, double product,
                                      double squared_sum) {
  const double scalar_product = a.dot(b);
  const double complement =
      scalar_product >= 0 ? product + scalar_product : cross(a, b).squaredNorm() / (product - scalar_product);
  return 2 * complement / squared_sum;
}

/// Evaluates b(x) for the segment AB, whose squared length is x·squared_sum. Returns +infinity when the
/// origin lies on the segment.
inline double atanh_excess(const Eigen::Vector3d& a, const Eigen::Vector3d& b, double product, double x,
                           double squared_sum) {
  if (x < logarithm_limit)
    return atanh_excess(x);
  const double one_minus_x = one_minus_squared_ratio(a, b, product, squared_sum);
  if (!(one_minus_x > 0))
    return std::numeric_limits<double>::infinity();
  const double one_plus_root = 1 + std::sqrt(x);
  return atanh_excess(x, 0.5 * std::log(one_plus_root * one_plus_root / one_minus_x));
}

/// Computes the edge moment E(A, B) = ∫₀¹ s ds/|A + s(B − A)|, given |A| and |B|. All terms except one
/// bounded term are positive, so no digits are lost for any A and B. Returns +infinity when the integral
/// diverges: when B is the origin, or the origin lies inside the segment.
inline double edge_moment(const Eigen::Vector3d& a, const Eigen::Vector3d& b, double norm_a, double norm_b) {
  if (norm_a == 0)
    return 1 / norm_b;
  if (norm_b == 0)
    return std::numeric_limits<double>::infinity();
  const Eigen::Vector3d edge = b - a;
  const double sum = norm_a + norm_b;
  const double squared_sum = sum * sum;
  const double excess = atanh_excess(a, b, norm_a * norm_b, edge.squaredNorm() / squared_sum, squared_sum);
  return (1 - 2 * a.dot(edge) / squared_sum * excess) / sum;
}

/// Computes M(A, B) = ∫₀¹ ds/|A + s(B − A)|, the mean of 1/distance along the segment, given |A| and |B|.
inline double mean_inverse_distance(const Eigen::Vector3d& a, const Eigen::Vector3d& b, double norm_a,
                                    double norm_b) {
  const double sum = norm_a + norm_b;
  const double squared_sum = sum * sum;
  const double x = (b - a).squaredNorm() / squared_sum;
  return 2 * (1 + x * atanh_excess(a, b, norm_a * norm_b, x, squared_sum)) / sum;
}

/// Computes ln(b/a) for a, b > 0, also where the quotient b/a overflows or underflows.
inline double log_of_ratio(double b, double a) {
  const double ratio = b / a;
  return std::isnormal(ratio) ? std::log(ratio) : std::log(b) - std::log(a);
}

/// Computes E(a, b) = ∫₀¹ s ds/(a + s(b − a)) for distances a, b ≥ 0: the edge moment of a segment on a line
/// through the origin.
inline double edge_moment(double a, double b) {
  if (a == 0)
    return 1 / b;
  if (b == 0)
    return std::numeric_limits<double>::infinity();
  const double sum = a + b;
  const double w = (b - a) / sum;
  const double x = w * w;
  const double excess =
      x < logarithm_limit ? atanh_excess(x) : atanh_excess(x, 0.5 * std::abs(log_of_ratio(b, a)));
  return (1 - 2 * a * w / sum * excess) / sum;
}

}  // namespace fringe::detail
