#pragma once

/// Small functions over a vector register, for any `V` with the operations of xsimd::batch<double> or
/// OneLane. `Lanes` states how the instruction sets differ.
namespace fringe::detail {

template <class V>
struct Vector3 {
  V x, y, z;
};

template <class V>
Vector3<V> operator-(const Vector3<V>& a, const Vector3<V>& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}

template <class V>
Vector3<V> operator+(const Vector3<V>& a, const Vector3<V>& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}

/// Computes a + t·b.
template <class V>
Vector3<V> along(const Vector3<V>& a, const V& t, const Vector3<V>& b) {
  return {fma(t, b.x, a.x), fma(t, b.y, a.y), fma(t, b.z, a.z)};
}

template <class V>
V dot(const Vector3<V>& a, const Vector3<V>& b) {
  return fma(a.x, b.x, fma(a.y, b.y, a.z * b.z));
}

template <class V>
V squared_norm(const Vector3<V>& a) {
  return dot(a, a);
}

/// Computes the rounding error of the product ab = fl(a·b) exactly.
template <class Lanes, class V>
V product_error(const V& a, const V& b, const V& ab) {
  if constexpr (Lanes::fused) {
    return fms(a, b, ab);
  } else {
    // Veltkamp's splitting and Dekker's product, for machines without fused multiply-add.
    const V splitter(0x1p27 + 1);
    const V a_scaled = splitter * a, b_scaled = splitter * b;
    const V a_high = a_scaled - (a_scaled - a), b_high = b_scaled - (b_scaled - b);
    const V a_low = a - a_high, b_low = b - b_high;
    return a_low * b_low - (((ab - a_high * b_high) - a_low * b_high) - a_high * b_low);
  }
}

/// Computes a·b − c·d with an error of at most 1.5 units in the last place (compensated.hpp).
template <class Lanes, class V>
V difference_of_products(const V& a, const V& b, const V& c, const V& d) {
  const V subtracted = c * d;
  if constexpr (Lanes::fused) {
    return fms(a, b, subtracted) - fms(c, d, subtracted);
  } else {
    const V kept = a * b;
    return (kept - subtracted) + (product_error<Lanes>(a, b, kept) - product_error<Lanes>(c, d, subtracted));
  }
}

template <class Lanes, class V>
Vector3<V> cross(const Vector3<V>& a, const Vector3<V>& b) {
  return {difference_of_products<Lanes>(a.y, b.z, a.z, b.y),
          difference_of_products<Lanes>(a.z, b.x, a.x, b.z),
          difference_of_products<Lanes>(a.x, b.y, a.y, b.x)};
}

template <class M, class V>
Vector3<V> select(const M& condition, const Vector3<V>& a, const Vector3<V>& b) {
  return {select(condition, a.x, b.x), select(condition, a.y, b.y), select(condition, a.z, b.z)};
}

/// Evaluates a polynomial, given its coefficients in ascending order.
template <class V, int terms>
V polynomial(const V& x, const double (&coefficients)[terms]) {
  // Even and odd powers are summed separately: two short dependency chains instead of a long one.
  const V y = x * x;
  V even(coefficients[(terms - 1) / 2 * 2]), odd(coefficients[(terms - 2) / 2 * 2 + 1]);
  for (int k = (terms - 1) / 2 * 2 - 2; k >= 0; k -= 2)
    even = fma(even, y, V(coefficients[k]));
  for (int k = (terms - 2) / 2 * 2 - 1; k >= 1; k -= 2)
    odd = fma(odd, y, V(coefficients[k]));
  return fma(odd, x, even);
}

}  // namespace fringe::detail
