#pragma once

#include "integral/batch/kernels.hpp"
#include "numeric/quadrature_rules.hpp"
#include "simd/vector_math.hpp"

/// The closed forms of the kernel K and the Gauss rule along the height (model/NUMERICS.md, sections 3 to 5),
/// one triangle per lane.
namespace fringe::detail {

/// Polynomial coefficients of b(x) = (atanh(√x)/√x − 1)/x on [0, 1/4] and on [0, 1/64], by interpolation at
/// the Chebyshev points, with errors of 7e-18 and 2e-18. tests/model/integral/batch_kernels_test.cpp checks
/// them against the series.
inline constexpr double excess_to_quarter[] = {
    0.3333333333333333,   0.20000000000000864, 0.14285714285490106,  0.11111111133938968, 0.09090907881509189,
    0.07692345940270638,  0.06665886352701884, 0.05893099692590042,  0.05160769881147162, 0.05441915418234587,
    0.012292448728540531, 0.13557903913692299, -0.14450491183414468, 0.21098097885975797};
inline constexpr double excess_to_64th[] = {0.3333333333333333,  0.19999999999998924, 0.14285714286814805,
                                            0.11111110689127397, 0.09090986056034936, 0.07685116670922458,
                                            0.06998145965455345};

/// Lower bound of divisors, so that lanes whose results are discarded do not divide by zero.
inline constexpr double smallest = 1e-300;

/// Evaluates b(x), where x ≤ 1/4 in all lanes.
template <class V>
V excess(const V& x) {
  return all(x <= V(1.0 / 64)) ? polynomial(x, excess_to_64th) : polynomial(x, excess_to_quarter);
}

/// Argument x of b from which the logarithm is used, because no digits cancel there. Below, one halving of
/// the argument leads to the polynomial.
inline constexpr double lanes_logarithm_limit = 0.64;

/// Evaluates b(x) in lanes with x ≤ lanes_logarithm_limit, by atanh(w) = 2·atanh(w/(1 + √(1 − w²))).
template <class V>
V excess_to_logarithm(const V& x) {
  const auto beyond = x > V(0.25);
  if (!any(beyond))
    return excess(x);
  const V inverse = V(1) / (V(1) + sqrt(max(V(1) - x, V(0))));
  const V squared_inverse = inverse * inverse;
  const V value = excess(min(select(beyond, x * squared_inverse, x), V(0.25)));
  return select(beyond, fma(V(2) * value, inverse, V(1)) * squared_inverse, value);
}

/// Evaluates b(x) of a segment on a line through the origin, from the distances a and b of its ends, both
/// positive, and w = (b − a)/(a + b).
template <class Lanes, class V>
V excess_of_heights(const V& a, const V& b, const V& w) {
  const V x = w * w;
  V value = excess_to_logarithm(x);
  const auto beyond = x > V(lanes_logarithm_limit);
  if (any(beyond)) {
    const V atanh = V(0.5) * Lanes::log(max(a, b) / min(a, b));
    value = select(beyond, (atanh / abs(w) - V(1)) / x, value);
  }
  return value;
}

/// Computes K of three positive heights: the second divided difference of z·ln z.
template <class Lanes, class V>
V kernel_of_heights(const V& z0, const V& z1, const V& z2) {
  const V low01 = min(z0, z1), high01 = max(z0, z1);
  const V low = min(low01, z2), high = max(high01, z2), middle = max(low01, min(high01, z2));
  const V span = high - low;
  const V near_share = (middle - low) / select(span == V(0), V(1), span);
  // One division provides the reciprocals of both sums S in the edge moments E = [1 − 2a·w/S·b]/S.
  const V near_sum = low + middle, far_sum = high + middle;
  const V inverse = V(1) / (near_sum * far_sum);
  const V inverse_near = inverse * far_sum, inverse_far = inverse * near_sum;
  const V w_near = (middle - low) * inverse_near, w_far = (middle - high) * inverse_far;
  const V bracket_near =
      V(1) - V(2) * low * inverse_near * w_near * excess_of_heights<Lanes>(low, middle, w_near);
  const V bracket_far =
      V(1) - V(2) * high * inverse_far * w_far * excess_of_heights<Lanes>(high, middle, w_far);
  const V moment_far = bracket_far * inverse_far;
  return fma(near_share, bracket_near * inverse_near - moment_far, moment_far);
}

/// Computes x·b(x) of the segment AB, where x = (|B − A|/(|A| + |B|))² and `moment` is A × B. Clears `safe`
/// in lanes where the origin almost lies on the segment.
template <class Lanes, class V>
V scaled_excess(const Vector3<V>& a, const Vector3<V>& b, const Vector3<V>& moment, const V& norm_a,
                const V& norm_b, const V& inverse_sum, typename Lanes::Mask& safe) {
  const V inverse_squared_sum = inverse_sum * inverse_sum;
  const V x = squared_norm(b - a) * inverse_squared_sum;
  V value = x * excess_to_logarithm(x);
  const auto beyond = x > V(lanes_logarithm_limit);
  if (any(beyond)) {
    const V product = norm_a * norm_b, scalar_product = dot(a, b);
    const V complement = select(scalar_product >= V(0), product + scalar_product,
                                squared_norm(moment) / max(product - scalar_product, V(smallest)));
    const V one_minus_x = V(2) * complement * inverse_squared_sum;
    safe = safe & (one_minus_x > V(1e-12));
    const V width = sqrt(x), one_plus = V(1) + width;
    const V atanh = V(0.5) * Lanes::log(one_plus * one_plus / max(one_minus_x, V(smallest)));
    value = select(beyond, atanh / width - V(1), value);
  }
  return value;
}

/// Evaluates the closed form of the potential (Wilton), arranged so that it preserves its digits at any
/// distance unless the triangle is a sliver. Clears `safe` in lanes where the origin is too close to a vertex
/// or an edge.
template <class Lanes, class V>
V kernel_near(const Vector3<V>& v0, const Vector3<V>& v1, const Vector3<V>& v2, typename Lanes::Mask& safe) {
  const V r0 = sqrt(squared_norm(v0)), r1 = sqrt(squared_norm(v1)), r2 = sqrt(squared_norm(v2));
  const Vector3<V> edge01 = v1 - v0, edge12 = v2 - v1, edge20 = v0 - v2;
  const Vector3<V> moment01 = cross<Lanes>(v0, v1), moment12 = cross<Lanes>(v1, v2),
                   moment20 = cross<Lanes>(v2, v0);
  const V nearest = min(r0, min(r1, r2)), farthest = max(r0, max(r1, r2));

  // The edge from a vertex close to the origin to a distant one loses the digits of the former. In that case
  // the sum of the moments gives the area, provided that the origin is within about one height, where no
  // moment is much larger than the sum.
  const auto next_to = nearest < V(0.1) * farthest;
  const Vector3<V> doubled_area =
      select(next_to, moment01 + moment12 + moment20, cross<Lanes>(edge01, edge12));
  const V squared_area = squared_norm(doubled_area);
  const V longest = max(squared_norm(edge01), max(squared_norm(edge12), squared_norm(edge20)));
  safe = safe & (nearest > V(1e-6) * farthest) &
         ((!next_to) | (nearest * nearest * longest < V(2) * squared_area));
  const V inverse_squared_area = V(1) / squared_area;

  // The means of 1/distance along the edges are 2(1 + x·b)/S with S = |A| + |B|. Their weights add up to 1
  // and may be large, so only the difference of each mean from the common 2/T is weighted, where T is the
  // mean of the three S. The differences of the S come from differences of squares.
  const V difference01 = dot(edge01, v0 + v1) / (r0 + r1), difference12 = dot(edge12, v1 + v2) / (r1 + r2);
  const V difference20 = dot(edge20, v2 + v0) / (r2 + r0);
  const V sum01 = r0 + r1, sum12 = r1 + r2, sum20 = r2 + r0;
  const V common = V(2.0 / 3) * (r0 + r1 + r2);
  const V inverse_common = V(1) / common;
  const auto part = [&](const Vector3<V>& a, const Vector3<V>& b, const Vector3<V>& moment, const V& norm_a,
                        const V& norm_b, const V& sum, const V& common_minus_sum) {
    const V inverse_sum = V(1) / sum;
    const V scaled = scaled_excess<Lanes>(a, b, moment, norm_a, norm_b, inverse_sum, safe);
    return dot(doubled_area, moment) * fma(common, scaled, common_minus_sum) * inverse_sum;
  };
  const V third(1.0 / 3);
  const V weighted = part(v0, v1, moment01, r0, r1, sum01, third * (difference12 - difference20)) +
                     part(v1, v2, moment12, r1, r2, sum12, third * (difference20 - difference01)) +
                     part(v2, v0, moment20, r2, r0, sum20, third * (difference01 - difference12));

  const Vector3<V> foot = select(r0 == nearest, v0, select(r1 == nearest, v1, v2));
  const V volume = abs(dot(doubled_area, foot));
  const V denominator = r0 * r1 * r2 + dot(v0, v1) * r2 + dot(v1, v2) * r0 + dot(v2, v0) * r1;
  const V half_solid_angle = Lanes::atan2(volume, denominator);
  return V(2) * fma(fma(weighted, inverse_common, V(0) - volume * half_solid_angle), inverse_squared_area,
                    inverse_common);
}

/// Computes the edge moment E(A, B) = ∫₀¹ s ds/|A + s(B − A)|.
template <class Lanes, class V>
V edge_moment(const Vector3<V>& a, const Vector3<V>& b, const V& norm_a, const V& norm_b) {
  const Vector3<V> edge = b - a;
  const V inverse_sum = V(1) / (norm_a + norm_b);
  const V inverse_squared_sum = inverse_sum * inverse_sum;
  const V x = squared_norm(edge) * inverse_squared_sum;
  V value = excess_to_logarithm(x);
  const auto beyond = x > V(lanes_logarithm_limit);
  if (any(beyond)) {
    const V complement = norm_a * norm_b + dot(a, b);
    const V width = sqrt(x), one_plus = V(1) + width;
    const V atanh = V(0.5) * Lanes::log(one_plus * one_plus / (V(2) * complement * inverse_squared_sum));
    value = select(beyond, (atanh / width - V(1)) / x, value);
  }
  return (V(1) - V(2) * dot(a, edge) * inverse_squared_sum * value) * inverse_sum;
}

template <class V>
V squared_distance_to_segment(const Vector3<V>& a, const Vector3<V>& b) {
  const Vector3<V> edge = b - a;
  const V share = min(max((V(0) - dot(a, edge)) / max(squared_norm(edge), V(smallest)), V(0)), V(1));
  return squared_norm(along(a, share, edge));
}

/// Computes the squared distance from the origin to a triangle, accurate enough to choose a formula.
template <class V>
V squared_distance_to_triangle(const Vector3<V>& v0, const Vector3<V>& v1, const Vector3<V>& v2) {
  const auto plain_cross = [](const Vector3<V>& a, const Vector3<V>& b) -> Vector3<V> {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
  };
  const Vector3<V> normal = plain_cross(v1 - v0, v2 - v0);
  const auto inside = (dot(normal, plain_cross(v0, v1)) > V(0)) & (dot(normal, plain_cross(v1, v2)) > V(0)) &
                      (dot(normal, plain_cross(v2, v0)) > V(0));
  const V volume = dot(normal, v0);
  const V to_border = min(squared_distance_to_segment(v0, v1),
                          min(squared_distance_to_segment(v1, v2), squared_distance_to_segment(v2, v0)));
  return select(inside, volume * volume / max(squared_norm(normal), V(smallest)), to_border);
}

/// A virtual triangle with its vertices renamed so that a–b is its longest edge and a is the end nearer to
/// the third vertex m.
template <class V>
struct LanesHeightSplit {
  Vector3<V> a, b, m;
  V share;            ///< the foot of m on the longest edge is a + share·(b − a)
  Vector3<V> height;  ///< from m to its foot
};

template <class V>
LanesHeightSplit<V> split_at_height(const Vector3<V>& v0, const Vector3<V>& v1, const Vector3<V>& v2) {
  const V opposite0 = squared_norm(v2 - v1), opposite1 = squared_norm(v0 - v2),
          opposite2 = squared_norm(v1 - v0);
  const V longest = max(opposite0, max(opposite1, opposite2));
  const auto at0 = opposite0 == longest, at1 = opposite1 == longest;
  const Vector3<V> m = select(at0, v0, select(at1, v1, v2));
  const Vector3<V> first = select(at0, v1, select(at1, v2, v0));
  const Vector3<V> second = select(at0, v2, select(at1, v0, v1));
  const auto swap = squared_norm(m - first) > squared_norm(m - second);
  const Vector3<V> a = select(swap, second, first), b = select(swap, first, second);
  const Vector3<V> edge = b - a;
  // A triangle collapsed to a point has no longest edge, and any share will do.
  const V share = max(V(0), dot(m - a, edge)) / max(longest, V(smallest));
  return {a, b, m, share, along(a, share, edge) - m};
}

/// Computes K by a Gauss rule along the height.
template <class Lanes, class V>
V kernel_along_height(const LanesHeightSplit<V>& split, const GaussNode* nodes, int points) {
  const V norm_a = sqrt(squared_norm(split.a)), norm_b = sqrt(squared_norm(split.b));
  V near_half(0), far_half(0);
  for (int i = 0; i < points; ++i) {
    const Vector3<V> point = along(split.m, V(nodes[i].position), split.height);
    const V norm_point = sqrt(squared_norm(point));
    const V weight(nodes[i].weight);
    near_half = fma(weight, edge_moment<Lanes>(split.a, point, norm_a, norm_point), near_half);
    far_half = fma(weight, edge_moment<Lanes>(split.b, point, norm_b, norm_point), far_half);
  }
  return fma(split.share, near_half, (V(1) - split.share) * far_half);
}

}  // namespace fringe::detail
