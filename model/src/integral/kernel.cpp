#include "integral/kernel.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "integral/edge_moment.hpp"
#include "numeric/compensated.hpp"
#include "numeric/infinity.hpp"
#include "numeric/quadrature_rules.hpp"

namespace fringe::detail {
namespace {

using Eigen::Vector3d;

/// A triangle with its vertices renamed so that `a`–`b` is the longest edge and `a` is the end nearer to the
/// third vertex `m`.
struct HeightSplit {
  Vector3d a, b, m;
  double squared_length;  ///< |b − a|²
  double share;           ///< t in [0, 1/2]: the foot of m on the longest edge is a + t(b − a)
  Vector3d height;        ///< from m to its foot
};

HeightSplit split_at_height(const Vector3d& v0, const Vector3d& v1, const Vector3d& v2) {
  const double opposite0 = (v2 - v1).squaredNorm();
  const double opposite1 = (v0 - v2).squaredNorm();
  const double opposite2 = (v1 - v0).squaredNorm();
  const Vector3d *a = &v0, *b = &v1, *m = &v2;
  if (opposite0 >= opposite1 && opposite0 >= opposite2)
    a = &v1, b = &v2, m = &v0;
  else if (opposite1 >= opposite2)
    a = &v2, b = &v0, m = &v1;
  // With m nearer to a, the share t is computed without cancellation however small it is, and rounding of 1 −
  // t ≥ 1/2 is harmless.
  if ((*m - *a).squaredNorm() > (*m - *b).squaredNorm())
    std::swap(a, b);
  // If two edges are equally long up to rounding, choose the one that contains the foot of the third vertex:
  // between a and m, 1/distance may be so large that even a share of 1e-17 matters.
  if ((*m - *a).dot(*b - *a) < 0)
    std::swap(a, m);
  const double squared_length = (*b - *a).squaredNorm();
  const double share =
      squared_length > 0 ? std::clamp((*m - *a).dot(*b - *a) / squared_length, 0.0, 1.0) : 0.0;
  return {*a, *b, *m, squared_length, share, *a + share * (*b - *a) - *m};
}

/// Computes the squared distance from the origin to the segment ab.
double squared_distance_to_segment(const Vector3d& a, const Vector3d& b) {
  const Vector3d edge = b - a;
  const double squared_length = edge.squaredNorm();
  const double s = squared_length > 0 ? std::clamp(-a.dot(edge) / squared_length, 0.0, 1.0) : 0.0;
  return (a + s * edge).squaredNorm();
}

/// Computes the squared distance from the origin to a triangle to a few per cent, which is enough to choose a
/// formula.
double squared_distance_to_triangle(const Vector3d& v0, const Vector3d& v1, const Vector3d& v2) {
  const Vector3d normal = cross(v1 - v0, v2 - v0);
  const bool projects_inside =
      normal.dot(cross(v0, v1)) > 0 && normal.dot(cross(v1, v2)) > 0 && normal.dot(cross(v2, v0)) > 0;
  if (projects_inside) {
    const double volume = normal.dot(v0);
    return volume * volume / normal.squaredNorm();
  }
  return std::min({squared_distance_to_segment(v0, v1), squared_distance_to_segment(v1, v2),
                   squared_distance_to_segment(v2, v0)});
}

/// Evaluates Wilton's closed form (model/NUMERICS.md, section 5). It is accurate while the origin is within
/// about one height of the triangle, because then no term is much larger than the sum.
double kernel_near(const HeightSplit& split) {
  const std::array<Vector3d, 3> v{split.a, split.b, split.m};
  const std::array<double, 3> r{v[0].norm(), v[1].norm(), v[2].norm()};
  const std::array<Vector3d, 3> moments{cross(v[0], v[1]), cross(v[1], v[2]), cross(v[2], v[0])};
  // The area vector is not taken from the cross product of two edges. This close to the triangle the three
  // moments are no larger than their sum, whereas the difference of a vertex close to the origin and a
  // distant one loses the digits of the former.
  const Vector3d doubled_area = moments[0] + moments[1] + moments[2];
  const double twice_area = doubled_area.norm();
  const Vector3d normal = doubled_area / twice_area;

  double sum = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t j = (i + 1) % 3;
    const double mean = mean_inverse_distance(v[i], v[j], r[i], r[j]);
    // An edge through the origin contributes nothing: as the origin approaches the edge, the edge's distance
    // from it tends to zero faster than the mean of 1/distance along the edge grows.
    if (std::isfinite(mean))
      sum += normal.dot(moments[i]) * mean;
  }
  const auto nearest = static_cast<std::size_t>(std::min_element(r.begin(), r.end()) - r.begin());
  const double distance_to_plane = std::abs(normal.dot(v[nearest]));
  const double half_solid_angle =
      std::atan2(distance_to_plane * twice_area,
                 r[0] * r[1] * r[2] + v[0].dot(v[1]) * r[2] + v[1].dot(v[2]) * r[0] + v[2].dot(v[0]) * r[1]);
  return (sum - distance_to_plane * 2 * half_solid_angle) / twice_area;
}

/// Evaluates the integrand of the split formula at a point of the height: one edge moment for each half of
/// the triangle.
double split_integrand(const HeightSplit& split, double norm_a, double norm_b, const Vector3d& point) {
  const double norm_point = point.norm();
  const double far_half = (1 - split.share) * edge_moment(split.b, point, norm_b, norm_point);
  return split.share > 0 ? split.share * edge_moment(split.a, point, norm_a, norm_point) + far_half
                         : far_half;
}

/// Gauss rules for the split formula, each with the smallest squared ratio of distance to height for which it
/// suffices.
class HeightRules {
 public:
  HeightRules() {
    for (int points = 1; points <= most_points; ++points) {
      // The integrand is analytic in the ellipse with foci 0 and 1 whose semi-axes add up to R/2, where
      // asinh(2·ratio) = ln R. An n-point rule then has an error of about R^(−2n), which must be at most
      // 2^−54.
      const double smallest_ratio = std::sinh(54 * std::log(2.0) / (2.0 * points)) / 2;
      rules_.push_back({smallest_ratio * smallest_ratio, gauss_rule(points)});
    }
  }

  /// Returns the squared ratio from which most_points suffice. Closer to the triangle, Wilton's closed form
  /// is the accurate one.
  double smallest_squared_ratio() const { return rules_.back().smallest_squared_ratio; }

  const GaussRule& rule(double squared_ratio) const {
    return std::find_if(rules_.begin(), rules_.end() - 1,
                        [=](const Entry& entry) { return squared_ratio >= entry.smallest_squared_ratio; })
        ->rule;
  }

 private:
  /// Largest number of Gauss points. 13 points suffice from a ratio of distance to height of 1. The terms of
  /// Wilton's form outgrow their sum in proportion to the ratio: at 1.3 they are six times as large, which
  /// amplifies the rounding of each by that factor.
  static constexpr int most_points = 13;

  struct Entry {
    double smallest_squared_ratio;
    GaussRule rule;
  };
  std::vector<Entry> rules_;
};

/// Squared ratio of height to longest edge below which the height is rounding error in the foot's
/// coordinates: for three collinear vectors the computed foot is wrong by up to √2 units of 2^−52.
constexpr double collinear_squared_fraction =
    2 * std::numeric_limits<double>::epsilon() * std::numeric_limits<double>::epsilon();

/// Smallest length whose sixth power, the highest power that occurs, is far from underflow even for thin
/// triangles. Vectors outside [smallest_length, 1/smallest_length] are rescaled first.
constexpr double smallest_length = 0x1p-100;

}  // namespace

double kernel(const Vector3d& v0, const Vector3d& v1, const Vector3d& v2) {
  static const HeightRules height_rules;
  const double largest =
      std::max({v0.lpNorm<Eigen::Infinity>(), v1.lpNorm<Eigen::Infinity>(), v2.lpNorm<Eigen::Infinity>()});
  if (largest == 0)
    return infinity;
  // A difference of coordinates that overflows is infinitely far away.
  if (std::isinf(largest))
    return 0;
  // K is homogeneous of degree −1: scaling by a power of two brings the vectors to where squared lengths
  // neither underflow nor overflow.
  if (largest < smallest_length || largest > 1 / smallest_length) {
    const int exponent = -std::ilogb(largest);
    // ldexp instead of a product: for the smallest lengths the power of two itself would overflow.
    const auto scaled = [=](const Vector3d& v) -> Vector3d {
      return v.unaryExpr([=](double x) { return std::ldexp(x, exponent); });
    };
    return std::ldexp(kernel(scaled(v0), scaled(v1), scaled(v2)), exponent);
  }
  const HeightSplit split = split_at_height(v0, v1, v2);
  if (split.squared_length == 0)
    return 0.5 / v0.norm();
  const double norm_a = split.a.norm(), norm_b = split.b.norm();
  const double squared_height = split.height.squaredNorm();
  if (squared_height <= collinear_squared_fraction * split.squared_length)
    return split_integrand(split, norm_a, norm_b, split.m);

  const double squared_ratio = squared_distance_to_triangle(v0, v1, v2) / squared_height;
  if (squared_ratio < height_rules.smallest_squared_ratio())
    return kernel_near(split);
  double sum = 0;
  for (const auto& [node, weight] : height_rules.rule(squared_ratio))
    sum += weight * split_integrand(split, norm_a, norm_b, split.m + node * split.height);
  return sum;
}

double kernel_of_heights(double z0, double z1, double z2) {
  std::array<double, 3> z{z0, z1, z2};
  std::sort(z.begin(), z.end());
  if (z[0] < 0 && z[2] > 0)
    return infinity;
  if (z[2] <= 0)
    z = {std::abs(z[2]), std::abs(z[1]), std::abs(z[0])};
  if (z[0] == z[2])
    return 0.5 / z[0];
  // The second divided difference of t·ln t, written so that every term is positive. With z₀ = z₁ = 0 the far
  // edge moment is infinite; with z₀ = 0 alone the near one is 1/z₁.
  const double far_half = (z[2] - z[1]) * edge_moment(z[2], z[1]);
  const double near_half = z[1] > z[0] ? (z[1] - z[0]) * edge_moment(z[0], z[1]) : 0.0;
  if (z[1] == 0)
    return infinity;
  return (near_half + (z[2] > z[1] ? far_half : 0.0)) / (z[2] - z[0]);
}

double kernel_from_plate(const Vector3d& v0, const Vector3d& v1, const Vector3d& v2) {
  const bool upright = v0.head<2>().isZero(0) && v1.head<2>().isZero(0) && v2.head<2>().isZero(0);
  return upright ? kernel_of_heights(v0.z(), v1.z(), v2.z()) : kernel(v0, v1, v2);
}

}  // namespace fringe::detail
