#pragma once

#include <cstddef>

#include <immintrin.h>

namespace fringe::detail {

/// Sixteen floats: AVX-512 F.
struct SingleLanesAvx512 {
  using Vector = __m512;
  static constexpr std::ptrdiff_t width = 16;

  static Vector zero() { return _mm512_setzero_ps(); }
  static Vector all(float number) { return _mm512_set1_ps(number); }
  static Vector load(const float* from) { return _mm512_loadu_ps(from); }
  static void store(float* to, Vector a) { _mm512_storeu_ps(to, a); }
  static Vector add(Vector a, Vector b) { return _mm512_add_ps(a, b); }
  static Vector root(Vector a) { return _mm512_sqrt_ps(a); }
  static Vector absolute(Vector a) { return _mm512_abs_ps(a); }
  static Vector larger(Vector a, Vector b) { return _mm512_max_ps(a, b); }
  static Vector smaller(Vector a, Vector b) { return _mm512_min_ps(a, b); }
  static float least(Vector a) { return _mm512_reduce_min_ps(a); }
  static Vector subtract(Vector a, Vector b) { return _mm512_sub_ps(a, b); }
  static Vector multiply(Vector a, Vector b) { return _mm512_mul_ps(a, b); }
  static Vector multiply_add(Vector a, Vector b, Vector c) { return _mm512_fmadd_ps(a, b, c); }
  /// The processor's estimate, good to 2^−14, after one step of Newton's method: to rounding.
  static Vector inverse_root(Vector a) {
    const Vector y = _mm512_rsqrt14_ps(a);
    const Vector half = multiply(multiply(a, y), y);
    return multiply(y, _mm512_fnmadd_ps(half, all(0.5F), all(1.5F)));
  }
  static float sum(Vector a) { return _mm512_reduce_add_ps(a); }
};

}  // namespace fringe::detail
