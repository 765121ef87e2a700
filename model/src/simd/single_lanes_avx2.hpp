#pragma once

#include <cstddef>

#include <immintrin.h>

namespace fringe::detail {

/// Eight floats: AVX2 and FMA.
struct SingleLanesAvx2 {
  using Vector = __m256;
  static constexpr std::ptrdiff_t width = 8;

  static Vector zero() { return _mm256_setzero_ps(); }
  static Vector all(float number) { return _mm256_set1_ps(number); }
  static Vector load(const float* from) { return _mm256_loadu_ps(from); }
  static void store(float* to, Vector a) { _mm256_storeu_ps(to, a); }
  static Vector add(Vector a, Vector b) { return _mm256_add_ps(a, b); }
  static Vector root(Vector a) { return _mm256_sqrt_ps(a); }
  static Vector absolute(Vector a) { return _mm256_andnot_ps(all(-0.0F), a); }
  static Vector larger(Vector a, Vector b) { return _mm256_max_ps(a, b); }
  static Vector smaller(Vector a, Vector b) { return _mm256_min_ps(a, b); }
  static float least(Vector a) {
    const __m128 four = _mm_min_ps(_mm256_castps256_ps128(a), _mm256_extractf128_ps(a, 1));
    const __m128 halves = _mm_min_ps(four, _mm_movehl_ps(four, four));
    return _mm_cvtss_f32(_mm_min_ss(halves, _mm_shuffle_ps(halves, halves, 1)));
  }
  static Vector subtract(Vector a, Vector b) { return _mm256_sub_ps(a, b); }
  static Vector multiply(Vector a, Vector b) { return _mm256_mul_ps(a, b); }
  static Vector multiply_add(Vector a, Vector b, Vector c) { return _mm256_fmadd_ps(a, b, c); }
  /// The processor's estimate, good to 2^−11, after one step of Newton's method: to 3e-7.
  static Vector inverse_root(Vector a) {
    const Vector y = _mm256_rsqrt_ps(a);
    const Vector half = multiply(multiply(a, y), y);
    return multiply(y, _mm256_fnmadd_ps(half, all(0.5F), all(1.5F)));
  }
  static float sum(Vector a) {
    const __m128 four = _mm_add_ps(_mm256_castps256_ps128(a), _mm256_extractf128_ps(a, 1));
    const __m128 halves = _mm_add_ps(four, _mm_movehl_ps(four, four));
    return _mm_cvtss_f32(_mm_add_ss(halves, _mm_shuffle_ps(halves, halves, 1)));
  }
};

}  // namespace fringe::detail
