#pragma once

#include "integral/batch/kernels.hpp"
#include "integral/batch/kernels_template.hpp"
#include "numeric/quadrature_rules.hpp"
#include "simd/vector_math.hpp"

/// The gradient of the kernel K, G_i = −∂K/∂v_i = ∫λ_i v/|v|³ dλ, one triangle per lane: by a quadrature
/// rule, by a Gauss rule along the height, and in closed form (model/NUMERICS.md, section 15).
namespace fringe::detail {

/// A corner of a triangle in one cell of a plate: the vector from the plate's nearest point, and that point.
template <class V>
struct CornerLanes {
  Vector3<V> vector;
  V nearest_u, nearest_v;
};

/// ∫v/|v|³ and ∫n × v/|v|³ over the simplex of barycentric coordinates.
template <class V>
struct WrenchLanes {
  Vector3<V> force;
  Vector3<V> moment;
};

/// Computes n × g of a point n = (u, v, 0) of the plate.
template <class V>
Vector3<V> moment_of(const V& u, const V& v, const Vector3<V>& g) {
  return {v * g.z, V(0) - u * g.z, u * g.y - v * g.x};
}

/// Adds up the gradients at the three corners.
template <class V>
WrenchLanes<V> wrench_of(const CornerLanes<V>& a, const Vector3<V>& at_a, const CornerLanes<V>& b,
                         const Vector3<V>& at_b, const CornerLanes<V>& c, const Vector3<V>& at_c) {
  return {at_a + at_b + at_c, moment_of(a.nearest_u, a.nearest_v, at_a) +
                                  moment_of(b.nearest_u, b.nearest_v, at_b) +
                                  moment_of(c.nearest_u, c.nearest_v, at_c)};
}

/// Integrates by a rule on the triangle. The moments of 1/|v|³ in the nodes' coordinates s and t suffice,
/// since v is linear in them.
template <class Lanes, class V>
WrenchLanes<V> wrench_by_rule(const RuleChoice& rule, const CornerLanes<V> (&corners)[3]) {
  const Vector3<V> start = corners[0].vector, edge1 = corners[1].vector - start,
                   edge2 = corners[2].vector - start;
  V one(0), s(0), t(0), ss(0), st(0), tt(0);
  for (int i = 0; i < rule.points; ++i) {
    const TriangleNode& node = rule.nodes[i];
    const Vector3<V> point = along(along(start, V(node.second), edge1), V(node.third), edge2);
    const V root = inverse_square_root<Lanes>(squared_norm(point));
    const V inverse = root * root * root;
    one = fma(V(node.weight), inverse, one);
    s = fma(V(node.weight * node.second), inverse, s);
    t = fma(V(node.weight * node.third), inverse, t);
    ss = fma(V(node.weight * node.second * node.second), inverse, ss);
    st = fma(V(node.weight * node.second * node.third), inverse, st);
    tt = fma(V(node.weight * node.third * node.third), inverse, tt);
  }
  const V half(0.5);
  const auto combined = [&](const V& constant, const V& along1, const V& along2) -> Vector3<V> {
    const Vector3<V> sum =
        along(along(Vector3<V>{constant * start.x, constant * start.y, constant * start.z}, along1, edge1),
              along2, edge2);
    return {half * sum.x, half * sum.y, half * sum.z};
  };
  const Vector3<V> whole = combined(one, s, t), at1 = combined(s, ss, st), at2 = combined(t, st, tt);
  return wrench_of(corners[0], whole - at1 - at2, corners[1], at1, corners[2], at2);
}

/// The two moments of an edge AB seen from the origin: ∫s(1 − s)v/|v|³ ds and ∫s²v/|v|³ ds with v = A + s(B −
/// A), the negative derivatives of the edge moment E(A, B).
template <class V>
struct EdgeGradient {
  Vector3<V> start, end;
};

/// The function b(x) of near_forms.hpp and its derivative.
template <class V>
struct Excess {
  V value, slope;
};

/// Evaluates b(x) and b'(x) = (1/(1 − x) − 3b)/(2x), given 1 − x without cancellation.
template <class Lanes, class V>
Excess<V> excess_with_slope(const V& x, const V& one_minus_x) {
  V value = excess_to_logarithm(min(x, V(lanes_logarithm_limit)));
  const auto beyond = x > V(lanes_logarithm_limit);
  if (any(beyond)) {
    const V width = sqrt(x), one_plus = V(1) + width;
    const V atanh = V(0.5) * Lanes::log(one_plus * one_plus / max(one_minus_x, V(smallest)));
    value = select(beyond, (atanh / width - V(1)) / max(x, V(smallest)), value);
  }
  // Below the limit the difference cancels, and five terms of the series suffice.
  constexpr double series_below = 1e-3;
  const V series = V(0.2) + x * (V(2.0 / 7) + x * (V(3.0 / 9) + x * (V(4.0 / 11) + x * V(5.0 / 13))));
  const V slope = (V(1) / max(one_minus_x, V(smallest)) - V(3) * value) / (V(2) * max(x, V(series_below)));
  return {value, select(x < V(series_below), series, slope)};
}

/// Computes a·A + b·B + c·C.
template <class V>
Vector3<V> combination(const V& a, const Vector3<V>& first, const V& b, const Vector3<V>& second, const V& c,
                       const Vector3<V>& third) {
  return {fma(a, first.x, fma(b, second.x, c * third.x)), fma(a, first.y, fma(b, second.y, c * third.y)),
          fma(a, first.z, fma(b, second.z, c * third.z))};
}

/// Differentiates E(A, B) = (1 − q·b(x))/S with q = 2A·(B − A)/S², x = |B − A|²/S², S = |A| + |B|. The sum of
/// the unit vectors of A and B carries what is left where the origin almost lies on the edge.
template <class Lanes, class V>
EdgeGradient<V> edge_gradient(const Vector3<V>& a, const Vector3<V>& b, const V& norm_a, const V& norm_b,
                              const Vector3<V>& unit_a, const Vector3<V>& unit_b) {
  const Vector3<V> edge = b - a, units = unit_a + unit_b;
  const V inverse = V(1) / (norm_a + norm_b);
  const V squared_inverse = inverse * inverse;
  const V x = squared_norm(edge) * squared_inverse;
  const V one_minus_x = norm_a * norm_b * squared_norm(units) * squared_inverse;
  const Excess<V> excess = excess_with_slope<Lanes>(x, one_minus_x);
  const V q = V(2) * dot(a, edge) * squared_inverse;
  const V by_x = V(2) * q * excess.slope;
  // The derivative along the unit vector of an end, and along the sum of both.
  const V along_unit = squared_inverse * (V(1) - V(3) * q * excess.value + by_x * one_minus_x);
  const V across = by_x * squared_inverse * inverse;
  const V direct = V(2) * excess.value * squared_inverse * inverse;
  const Vector3<V> from_a = edge - a;
  return {combination(along_unit, unit_a, V(0) - across * norm_b, units, direct, from_a),
          combination(along_unit, unit_b, V(0) - across * norm_a, units, direct, a)};
}

/// Evaluates the closed form of region I, where the vectors are the heights of the corners, all of one sign:
/// the sum of both halves of section 4, each with the derivatives of its edge moment.
template <class Lanes, class V>
WrenchLanes<V> wrench_in_front(const CornerLanes<V> (&corners)[3]) {
  struct Corner {
    V height, u, v;
  };
  const auto corner = [&](int k) {
    return Corner{abs(corners[k].vector.z), corners[k].nearest_u, corners[k].nearest_v};
  };
  Corner low = corner(0), middle = corner(1), high = corner(2);
  const auto order = [](Corner& first, Corner& second) {
    const auto swap = second.height < first.height;
    const Corner lower{min(first.height, second.height), select(swap, second.u, first.u),
                       select(swap, second.v, first.v)};
    second = {max(first.height, second.height), select(swap, first.u, second.u),
              select(swap, first.v, second.v)};
    first = lower;
  };
  order(low, middle);
  order(middle, high);
  order(low, middle);

  struct Moments {
    V start, end;
  };
  const auto moments = [](const V& a, const V& b) -> Moments {
    const V inverse = V(1) / (a + b), squared_inverse = inverse * inverse;
    const V edge = b - a, width = edge * inverse;
    const Excess<V> excess = excess_with_slope<Lanes>(width * width, V(4) * a * b * squared_inverse);
    const V q = V(2) * a * inverse * width;
    const V by_x = V(2) * q * excess.slope;
    const V along_unit = V(1) - V(3) * q * excess.value + by_x * V(4) * a * b * squared_inverse;
    const V twice = V(2) * inverse;
    return {squared_inverse * (along_unit + twice * (excess.value * (edge - a) - by_x * b)),
            squared_inverse * (along_unit + twice * (excess.value - by_x) * a)};
  };
  const V span = high.height - low.height;
  const V share = (middle.height - low.height) / select(span == V(0), V(1), span), other = V(1) - share;
  const Moments near = moments(low.height, middle.height), far = moments(high.height, middle.height);
  const V at_middle = V(0.5) * fma(share, near.end, other * far.end);
  const V at_low = fma(share, near.start, other * at_middle),
          at_high = fma(other, far.start, share * at_middle);
  const auto above = corners[0].vector.z > V(0);
  const auto signed_sum = [&](const V& weight_low, const V& weight_middle, const V& weight_high) {
    const V sum = fma(weight_low, at_low, fma(weight_middle, at_middle, weight_high * at_high));
    return select(above, sum, V(0) - sum);
  };
  const V zero(0), one(1);
  return {{zero, zero, signed_sum(one, one, one)},
          {signed_sum(low.v, middle.v, high.v), zero - signed_sum(low.u, middle.u, high.u), zero}};
}

/// Integrates by a Gauss rule along the height on the longest edge, over closed forms along the segments from
/// that edge's ends to the height; one point suffices for collinear vectors.
template <class Lanes, class V>
WrenchLanes<V> wrench_along_height(const CornerLanes<V> (&corners)[3], const GaussNode* nodes, int points) {
  const auto& [c0, c1, c2] = corners;
  const V opposite0 = squared_norm(c2.vector - c1.vector), opposite1 = squared_norm(c0.vector - c2.vector),
          opposite2 = squared_norm(c1.vector - c0.vector);
  const V longest = max(opposite0, max(opposite1, opposite2));
  const auto at0 = opposite0 == longest, at1 = opposite1 == longest;
  const auto chosen = [](const auto& mask, const CornerLanes<V>& one, const CornerLanes<V>& other) {
    return CornerLanes<V>{select(mask, one.vector, other.vector),
                          select(mask, one.nearest_u, other.nearest_u),
                          select(mask, one.nearest_v, other.nearest_v)};
  };
  const CornerLanes<V> m = chosen(at0, c0, chosen(at1, c1, c2));
  const CornerLanes<V> first = chosen(at0, c1, chosen(at1, c2, c0));
  const CornerLanes<V> second = chosen(at0, c2, chosen(at1, c0, c1));
  const auto swap = squared_norm(m.vector - first.vector) > squared_norm(m.vector - second.vector);
  const CornerLanes<V> a = chosen(swap, second, first), b = chosen(swap, first, second);
  const Vector3<V> edge = b.vector - a.vector;
  const V share = max(V(0), dot(m.vector - a.vector, edge)) / max(longest, V(smallest));
  const V other_share = V(1) - share;
  const Vector3<V> height = along(a.vector, share, edge) - m.vector;

  const auto scaled = [](const V& factor, const Vector3<V>& vector) -> Vector3<V> {
    return {factor * vector.x, factor * vector.y, factor * vector.z};
  };
  const V norm_a = sqrt(squared_norm(a.vector)), norm_b = sqrt(squared_norm(b.vector));
  const Vector3<V> unit_a = scaled(V(1) / norm_a, a.vector), unit_b = scaled(V(1) / norm_b, b.vector);
  const Vector3<V> zero{V(0), V(0), V(0)};
  Vector3<V> at_a = zero, at_b = zero, at_m = zero, at_foot = zero;
  for (int i = 0; i < points; ++i) {
    const Vector3<V> point = along(m.vector, V(nodes[i].position), height);
    const V norm = sqrt(squared_norm(point));
    const Vector3<V> unit = scaled(V(1) / norm, point);
    const EdgeGradient<V> from_a = edge_gradient<Lanes>(a.vector, point, norm_a, norm, unit_a, unit);
    const EdgeGradient<V> from_b = edge_gradient<Lanes>(b.vector, point, norm_b, norm, unit_b, unit);
    const V weight(nodes[i].weight);
    at_a = along(at_a, weight * share, from_a.start);
    at_b = along(at_b, weight * other_share, from_b.start);
    const Vector3<V> at_point = along(scaled(share, from_a.end), other_share, from_b.end);
    at_m = along(at_m, weight * V(1 - nodes[i].position), at_point);
    at_foot = along(at_foot, weight * V(nodes[i].position), at_point);
  }
  return wrench_of(a, along(at_a, other_share, at_foot), b, along(at_b, share, at_foot), m, at_m);
}

/// Evaluates the closed form: the potential and the solid angle of a uniformly charged triangle, and the
/// moments of 1/|v| along its edges.
template <class Lanes, class V>
WrenchLanes<V> wrench_closed(const CornerLanes<V> (&corners)[3]) {
  const Vector3<V>&v0 = corners[0].vector, &v1 = corners[1].vector, &v2 = corners[2].vector;
  const V r0 = sqrt(squared_norm(v0)), r1 = sqrt(squared_norm(v1)), r2 = sqrt(squared_norm(v2));
  const Vector3<V> edge01 = v1 - v0, edge12 = v2 - v1, edge20 = v0 - v2;
  const Vector3<V> moment01 = cross<Lanes>(v0, v1), moment12 = cross<Lanes>(v1, v2),
                   moment20 = cross<Lanes>(v2, v0);
  const V nearest = min(r0, min(r1, r2)), farthest = max(r0, max(r1, r2));
  // The edge from a vertex close to the origin to a distant one loses the digits of the former.
  const Vector3<V> area =
      select(nearest < V(0.1) * farthest, moment01 + moment12 + moment20, cross<Lanes>(edge01, edge12));
  const V inverse = V(1) / squared_norm(area);

  // The moments of 1/|v| along an edge from A to B, weighted to A and to B.
  struct Moments {
    V start, end;
  };
  const auto moments = [](const Vector3<V>& a, const Vector3<V>& b, const Vector3<V>& edge, const V& norm_a,
                          const V& norm_b, const Vector3<V>& moment) -> Moments {
    const V inverse_sum = V(1) / (norm_a + norm_b);
    const V squared_inverse = inverse_sum * inverse_sum;
    const V x = squared_norm(edge) * squared_inverse;
    V value = excess_to_logarithm(min(x, V(lanes_logarithm_limit)));
    const auto beyond = x > V(lanes_logarithm_limit);
    if (any(beyond)) {
      const V product = norm_a * norm_b, scalar_product = dot(a, b);
      const V complement = select(scalar_product >= V(0), product + scalar_product,
                                  squared_norm(moment) / max(product - scalar_product, V(smallest)));
      const V width = sqrt(x), one_plus = V(1) + width;
      const V atanh =
          V(0.5) * Lanes::log(one_plus * one_plus / max(V(2) * complement * squared_inverse, V(smallest)));
      value = select(beyond, (atanh / width - V(1)) / max(x, V(smallest)), value);
    }
    const V factor = V(2) * value * squared_inverse;
    return {fma(factor, dot(b, edge), V(1)) * inverse_sum,
            fma(V(0) - factor, dot(a, edge), V(1)) * inverse_sum};
  };
  const Moments on01 = moments(v0, v1, edge01, r0, r1, moment01);
  const Moments on12 = moments(v1, v2, edge12, r1, r2, moment12);
  const Moments on20 = moments(v2, v0, edge20, r2, r0, moment20);
  const V mean01 = on01.start + on01.end, mean12 = on12.start + on12.end, mean20 = on20.start + on20.end;

  const Vector3<V> foot = select(r0 == nearest, v0, select(r1 == nearest, v1, v2));
  const V volume = dot(area, foot);
  const V solid_angle =
      V(2) * Lanes::atan2(volume, r0 * r1 * r2 + dot(v0, v1) * r2 + dot(v1, v2) * r0 + dot(v2, v0) * r1);
  const V share0 = dot(area, moment12) * inverse, share1 = dot(area, moment20) * inverse,
          share2 = dot(area, moment01) * inverse;
  const V kernel = fma(share2, mean01, fma(share0, mean12, share1 * mean20)) - volume * solid_angle * inverse;

  // Outward normals of the edges in the triangle's plane, as long as the edges and times twice the area.
  const Vector3<V> out01 = cross<Lanes>(edge01, area), out12 = cross<Lanes>(edge12, area),
                   out20 = cross<Lanes>(edge20, area);
  const Vector3<V> whole = combination(mean01, out01, mean12, out12, mean20, out20);
  const V height = volume * inverse;
  const auto gradient = [&](const V& share, const Vector3<V>& opposite, const V& by01, const V& by12,
                            const V& by20) -> Vector3<V> {
    const Vector3<V> edges = along(combination(by01, out01, by12, out12, by20, out20), kernel, opposite);
    const V normal = inverse * fma(share, solid_angle, height * inverse * dot(opposite, whole));
    return {fma(normal, area.x, V(0) - inverse * edges.x), fma(normal, area.y, V(0) - inverse * edges.y),
            fma(normal, area.z, V(0) - inverse * edges.z)};
  };
  const V zero(0);
  return wrench_of(corners[0], gradient(share0, out12, on01.start, zero, on20.end), corners[1],
                   gradient(share1, out20, on01.end, on12.start, zero), corners[2],
                   gradient(share2, out01, zero, on12.end, on20.start));
}

}  // namespace fringe::detail
