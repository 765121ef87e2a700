#pragma once

#include <cstddef>

#include <emmintrin.h>

namespace fringe::detail {

/// Four floats: SSE2.
struct SingleLanesSse2 {
  using Vector = __m128;
  static constexpr std::ptrdiff_t width = 4;

  static Vector zero() { return _mm_setzero_ps(); }
  static Vector all(float number) { return _mm_set1_ps(number); }
  static Vector load(const float* from) { return _mm_loadu_ps(from); }
  static void store(float* to, Vector a) { _mm_storeu_ps(to, a); }
  static Vector add(Vector a, Vector b) { return _mm_add_ps(a, b); }
  static Vector root(Vector a) { return _mm_sqrt_ps(a); }
  static Vector absolute(Vector a) { return _mm_andnot_ps(all(-0.0F), a); }
  static Vector larger(Vector a, Vector b) { return _mm_max_ps(a, b); }
  static Vector smaller(Vector a, Vector b) { return _mm_min_ps(a, b); }
  static float least(Vector a) {
    const Vector halves = _mm_min_ps(a, _mm_movehl_ps(a, a));
    return _mm_cvtss_f32(_mm_min_ss(halves, _mm_shuffle_ps(halves, halves, 1)));
  }
  static Vector subtract(Vector a, Vector b) { return _mm_sub_ps(a, b); }
  static Vector multiply(Vector a, Vector b) { return _mm_mul_ps(a, b); }
  static Vector multiply_add(Vector a, Vector b, Vector c) { return _mm_add_ps(_mm_mul_ps(a, b), c); }
  static Vector inverse_root(Vector a) { return _mm_div_ps(all(1), _mm_sqrt_ps(a)); }
  static float sum(Vector a) {
    const Vector halves = _mm_add_ps(a, _mm_movehl_ps(a, a));
    return _mm_cvtss_f32(_mm_add_ss(halves, _mm_shuffle_ps(halves, halves, 1)));
  }
};

}  // namespace fringe::detail
